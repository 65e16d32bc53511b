/* Internal: recognises files of kinds that TIDES can't read. The error then names the kind and says what to do, where a
 * reader's own error would be about unexpected bytes. */
#ifndef TD_KINDS_H
#define TD_KINDS_H

#include "td_base.h"

/* The kind of file that the caller needs. */
enum { TD_WANTS_SCENE, TD_WANTS_EVENTS, TD_WANTS_POSES, TD_WANTS_FRAMES, TD_WANTS_RUN, TD_WANTS_TEXT, TD_WANTS_ANY, TD_WANTS };

/* Fails (TIDES_BAD_FILE) if the first bytes and the ending of the file show another kind than the wanted one; the error
 * names the kind and says what to do. TIDES_OK if the kind isn't recognised: then the reader's own error says more. */
tides_status td_kind_refuse(const char *path, int wanted, tides_error *error);

/* Called after a reader failed with `status`. If the kind of the file is recognised as a wrong one, replaces `error` by
 * advice about it, as td_kind_refuse does. Otherwise keeps the reader's error. */
tides_status td_kind_judge(const char *path, int wanted, tides_status status, tides_error *error);

#endif
