/* Internal: the kinds of files that people have and no reader here takes: told by name, with what gets further, in place of
 * what the last reader to try thinks of their bytes. */
#ifndef TD_KINDS_H
#define TD_KINDS_H

#include "td_base.h"

/* Kinds of file that a caller wanted. */
enum { TD_WANTS_SCENE, TD_WANTS_EVENTS, TD_WANTS_POSES, TD_WANTS_FRAMES, TD_WANTS_RUN, TD_WANTS_TEXT, TD_WANTS_ANY, TD_WANTS };

/* Fails (TIDES_BAD_FILE) where the file, by its first bytes and its name's ending, is of a kind that isn't what was wanted:
 * what it is, and what to do. TIDES_OK, and nothing is said, where nothing is known of it: the caller has more to say. */
tides_status td_kind_refuse(const char *path, int wanted, tides_error *error);

/* Like td_kind_refuse, for a reader that failed with `status`. Where the kind isn't known, the reader's own message in `error`
 * stays. */
tides_status td_kind_judge(const char *path, int wanted, tides_status status, tides_error *error);

#endif
