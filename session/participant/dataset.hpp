// The folder of a study with real processes: one participant after another, in the layout of BIDS (Brain
// Imaging Data Structure 1.8, "Behavioral experiments"), of virtual subjects or of people, never of both.
//
//     dataset_description.json   with our own key "SubjectKind"
//     participants.tsv, .json    a line per participant
//     task-needle_beh.json       what the columns of the trial tables mean
//     exclusions.tsv             trials left out or run again, and why
//     attention.tsv              which attention trials were passed
//     corrections.tsv            what was changed after the session, by whom, when and why
//     phenotype/                 consent, and answers to questionnaires (phenotype.hpp)
//     orders/sub-07_order.tsv    written before the first trial
//     sub-07/beh/sub-07_task-needle_beh.tsv      a line per trial
//     sourcedata/sub-07/trajectories/, nodes/    each sample; logs and reports of the programs
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "session/records/participant.hpp"
#include "session/settings/protocol_settings.hpp"

namespace thimble {

class Dataset {
  public:
    explicit Dataset(std::filesystem::path folder) : folder_(std::move(folder)) {}

    std::filesystem::path description() const { return folder_ / "dataset_description.json"; }
    std::filesystem::path participants() const { return folder_ / "participants.tsv"; }
    std::filesystem::path exclusions() const { return folder_ / "exclusions.tsv"; }
    std::filesystem::path attention() const { return folder_ / "attention.tsv"; }
    std::filesystem::path corrections() const { return folder_ / "corrections.tsv"; }
    std::filesystem::path order(std::uint32_t participant) const;
    std::filesystem::path records(std::uint32_t participant) const;
    std::filesystem::path source(std::uint32_t participant) const;
    const std::filesystem::path& folder() const { return folder_; }

    // Nothing if the folder holds no dataset. Throws Error (data) if it holds one that cannot be read.
    std::optional<SubjectKind> kind() const;
    // Makes a dataset of the folder, or checks that it is one of this kind. Throws Error (usage) if it is of
    // the other kind, or holds anything else.
    void open(SubjectKind kind, const DatasetSettings& settings) const;

  private:
    std::filesystem::path folder_;
};

// For programs that write other things: throws Error (usage) if `folder` holds a dataset of participants.
void refuse_dataset(const std::filesystem::path& folder);

// Of participants.tsv: a line per participant, added before the first trial and altered by corrections.hpp alone.
// Pseudonymous: a number and what the study needs; names, dates of birth and the signed consent belong elsewhere.
// "n/a" where it was not asked or not told. Values as BIDS wants them.
struct PersonDescription {
    std::string age = "n/a";                // whole years, "89+" from 89 on
    std::string sex = "n/a";                // M, F, O
    std::string handedness = "n/a";         // left, right, ambidextrous
    std::string haptic_experience = "n/a";  // with force-feedback devices: none, some, expert
    bool consent = false;                   // given on paper, as the experimenter says, or at the screen
    bool operator==(const PersonDescription&) const = default;
};

// "31", or "89+" for 89 and more. Throws Error (usage) for anything but 1 to 120, "89+" or "n/a".
std::string age_text(const std::string& years);

// Adds the participant if it is not there. Gives the line that stands in the file if it contradicts a known value of `person`.
std::string add_participant(const Dataset& dataset, std::uint32_t participant, SubjectKind kind,
                            const PersonDescription& person);

// A field of that line, e.g. "age". Throw Error (usage) if the participant is not there.
std::string person_field(const Dataset& dataset, std::uint32_t participant, std::string_view column);
// Replaces the file as a whole; corrections.hpp keeps a note of it.
void set_person_field(const Dataset& dataset, std::uint32_t participant, std::string_view column,
                      const std::string& value);

std::vector<std::uint32_t> read_participants(const Dataset& dataset);

// The files that BIDS asks for beside the tables: the meaning of each column, and a page for readers of the folder.
struct Sidecar {
    const char* file;
    std::string text;
};

// participants.json, task-needle_beh.json, README.md and .bidsignore.
std::vector<Sidecar> sidecars_of(SubjectKind kind, const std::string& name);

// Recorded movements as a dataset in the layout of Motion-BIDS (Brain Imaging Data Structure 1.9, "Motion"), made new from what a
// participant session, or `thimble study --trajectories`, has written. For each trial with a trajectory that has samples:
//
//     sub-07/motion/sub-07_task-needle_tracksys-slave_run-01_motion.tsv      a line per sample, without a header
//                   ..._motion.json, ..._channels.tsv                        what its columns are
//                   ..._events.tsv, ..._events.json                          the trial's conditions, puncture, contact with the fixture, beep
//
// run: the record of a participant session; of a study, or of `thimble run`, the trial's place, with the experiment in the task
// (task-needleExperiment3).
struct MotionExport {
    std::size_t subjects = 0, trials = 0;
    std::size_t without_trajectory = 0;  // of the trials in the tables
};

// `to` must be new or empty, and `from` a dataset or a study. Throws Error (usage) if they are not.
// Throws Error (data) if a file cannot be read, or if there is no trajectory. Throws Error (run failed) if a file cannot be written.
MotionExport export_motion(const std::filesystem::path& from, const std::filesystem::path& to);

}  // namespace thimble
