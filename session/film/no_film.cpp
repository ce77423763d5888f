// In place of film.cpp where there is nothing to draw with.
#include "common/error.hpp"
#include "session/film/film.hpp"

namespace thimble {

FilmResult make_film(const RecordedTrial& /*trial*/, const FilmPlan& /*plan*/) {
    throw Error(ExitCode::kUsage, "this build has no windows (THIMBLE_GUI is off), and so no pictures");
}

}  // namespace thimble
