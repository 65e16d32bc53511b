/* Levels of detail of scenes that hold themselves more than once (.lcc, .lcc2, streamed .sog): the choice of one, and the note
 * about it. */
#include "td_levels.h"
#include "td_base.h"
#include "td_model_files.h"

tides_status td_levels_choose(const char *path, const char *part, td_levels *levels, tides_error *error) {
    levels->level = part ? td_numbered(part, "", "") : 0;
    if (levels->level >= 0 && levels->level < levels->count) return TIDES_OK;
    return td_levels_refuse(path, part, levels->count, error);
}

tides_status td_levels_refuse(const char *path, const char *part, int64_t count, tides_error *error) {
    return td_fail(error, TIDES_BAD_ARGUMENT, "%s: scene.part = \"%.80s\" is none of its levels of detail, 0 to %lld", path,
                   part, (long long)count - 1);
}

tides_status td_levels_note(const td_levels *levels, char **notes, tides_error *error) {
    if (levels->count < 2) return TIDES_OK;
    return td_note(notes, error, "its level of detail %lld is read, of 0, the finest, to %lld: scene.part names another",
                   (long long)levels->level, (long long)levels->count - 1);
}
