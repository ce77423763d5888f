#include <array>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "common/json_text.hpp"
#include "session/participant/dataset.hpp"

namespace thimble {
namespace {

using Json = nlohmann::ordered_json;

struct ColumnMeaning {
    const char* name;
    const char* description;
    const char* units;  // BIDS: SI where possible; null: none
};

// The measures are defined in session/records/metrics.hpp.
constexpr std::array kMeanings{
    ColumnMeaning{"record", "Number of this line, in the order of time", nullptr},
    ColumnMeaning{"position", "Place in the participant's order, orders/sub-<label>_order.tsv", nullptr},
    ColumnMeaning{"block", "Trials between two breaks; 0: practice", nullptr},
    ColumnMeaning{"practice", "1: practice, not to be analysed", nullptr},
    ColumnMeaning{"repeat_of", "The record that this one replaces", nullptr},
    ColumnMeaning{"repeat_reason", "Why that trial was run again", nullptr},
    ColumnMeaning{"number_on_wire", "Number of the trial in the messages between the programs", nullptr},
    ColumnMeaning{"experiment", "1: no delay; 2: the fixture vanishes with the beep; 3: delayed force",
                  nullptr},
    ColumnMeaning{"subject", "Participant number", nullptr},
    ColumnMeaning{
        "trial",
        "Number within participant and experiment; from 1001 on: practice; from 2001 on: attention trials",
        nullptr},
    ColumnMeaning{"modality",
                  "How the force was displayed. HF: handle; CF: fingers of the acting hand; CCF: fingers of "
                  "the other hand; VF: bar on the screen",
                  nullptr},
    ColumnMeaning{"delay_s", "One-way delay of the force path that was asked for", "s"},
    ColumnMeaning{"fixture_position_m", "Depth of the virtual fixture", "m"},
    ColumnMeaning{"penetration_mean_m", "Mean penetration of the fixture until the beep", "m"},
    ColumnMeaning{"penetration_max_m", "Greatest penetration of the fixture", "m"},
    ColumnMeaning{"completion_time_s", "From the puncture to the beep", "s"},
    ColumnMeaning{"peak_displacement_m", "Greatest displacement after the fixture vanished", "m"},
    ColumnMeaning{"contacts_lost", "Times that contact with the fixture was lost before the beep", nullptr},
    ColumnMeaning{"oscillation_rms_m", "Root mean square of the oscillation", "m"},
    ColumnMeaning{"oscillation_peak_to_peak_m", "Peak to peak of the oscillation", "m"},
    ColumnMeaning{"oscillation_frequency_Hz", "Its dominant frequency", "Hz"},
    ColumnMeaning{"oscillates", "1: the needle oscillates at the fixture", nullptr},
    ColumnMeaning{"beeped", "1: contact was held long enough for the beep", nullptr},
    ColumnMeaning{"outcome",
                  "completed, timeout, interrupted, emergency_stop, peer_lost_<program>, "
                  "device_fault_<program>, or safety_stop_<program>",
                  nullptr},
    ColumnMeaning{"seed", "Seed of the study", nullptr},
    ColumnMeaning{"fixture_removed", "1: the fixture vanishes with the beep", nullptr},
    ColumnMeaning{"delay_achieved_s", "Median delay of the network, both ways together", "s"},
    ColumnMeaning{"round_trip_s", "Median time from an encoder sample to its force at the handle", "s"},
    ColumnMeaning{"puncture_time_s", "Since the start of the trial", "s"},
    ColumnMeaning{"first_contact_time_s", "With the fixture, since the start of the trial", "s"},
    ColumnMeaning{"duration_s", "Of the whole trial, withdrawal included", "s"},
    ColumnMeaning{"remedy", "Controller against delay that acted at the handle; none in CF, CCF and VF",
                  nullptr},
};

std::string behaviour_json() {
    Json json{
        {"TaskName", "needle"},
        {"TaskDescription",
         "Insert a needle into simulated tissue until a virtual fixture is felt or seen, hold the contact "
         "until the beep, withdraw."}};
    for (const ColumnMeaning& column : kMeanings) {
        json[column.name] = Json{{"Description", column.description}};
        if (column.units != nullptr) json[column.name]["Units"] = column.units;
    }
    return json_text(json, 2) + '\n';
}

std::string participants_json() {
    const Json json{
        {"participant_id", {{"Description", "Pseudonym; the key to it is not part of the dataset"}}},
        {"species", {{"Description", "n/a for a virtual subject"}}},
        {"age", {{"Description", "Age at the first session; 89+ for 89 and more"}, {"Units", "year"}}},
        {"sex",
         {{"Description", "As reported by the participant"},
          {"Levels", {{"M", "male"}, {"F", "female"}, {"O", "other"}}}}},
        {"handedness",
         {{"Description", "As reported by the participant"},
          {"Levels", {{"left", "left"}, {"right", "right"}, {"ambidextrous", "ambidextrous"}}}}},
        {"haptic_experience",
         {{"Description", "With force-feedback devices, as reported by the participant"},
          {"Levels", {{"none", "never used one"}, {"some", "used one"}, {"expert", "uses one regularly"}}}}},
        {"subject_kind",
         {{"Description", "Who held the handle"},
          {"Levels", {{"virtual", "a simulated operator"}, {"human", "a person"}}}}},
        {"consent",
         {{"Description",
           "yes: informed consent was given before the first trial, as the experimenter stated, or at the "
           "screen (phenotype/consent.tsv)"},
          {"Levels", {{"yes", "given"}}}}}};
    return json_text(json, 2) + '\n';
}

std::string readme(SubjectKind kind, const std::string& name) {
    return fmt::format(
        "# {}\n\nData of {} subjects, recorded by `thimble run`, in the layout of BIDS.\n\n"
        "Participants are pseudonymous: a number each. The list of names, the consent forms and whatever "
        "else "
        "identifies a person are kept elsewhere and never put into this folder. Reasons in `exclusions.tsv` "
        "are free text: keep names out of them.\n\n"
        "`orders/`: each participant's trials, written before the first one. `sub-*/beh/`: a line per trial "
        "(`task-needle_beh.json` says what the columns mean). `exclusions.tsv`: what was rejected or "
        "excluded, and why. `sourcedata/`: every sample, and the programs' logs.\n\n"
        "`thimble analyse` of this folder takes the trials that count and says which it left out.\n",
        name, to_string(kind));
}

}  // namespace

std::vector<Sidecar> sidecars_of(SubjectKind kind, const std::string& name) {
    return {{"participants.json", participants_json()},
            {"task-needle_beh.json", behaviour_json()},
            {"README.md", readme(kind, name)},
            {".bidsignore", "orders/\nexclusions.tsv\nattention.tsv\ncorrections.tsv\n"}};
}

}  // namespace thimble
