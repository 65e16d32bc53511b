/* Internal: recognises files of another kind than the caller needs, such as a video instead of events. The error then names
 * the kind and says what to do. A reader's own error would be about unexpected bytes. */
#ifndef TD_KINDS_H
#define TD_KINDS_H

#include "td_base.h"

/* The kind of file that the caller needs. TD_WANTS_ANY: any kind that TIDES reads. TD_WANTS: the number of these constants. */
enum { TD_WANTS_SCENE, TD_WANTS_EVENTS, TD_WANTS_POSES, TD_WANTS_FRAMES, TD_WANTS_RUN, TD_WANTS_TEXT, TD_WANTS_ANY, TD_WANTS };

/* Fails (TIDES_BAD_FILE) if the first bytes and the ending of the file show another kind than the wanted one; the error
 * names the kind and says what to do. Returns TIDES_OK if the kind is the wanted one or isn't recognised. */
tides_status td_kind_refuse(const char *path, int wanted, tides_error *error);

/* Called with a reader's `status` and error. If the reader failed on the file's content, or because the path is a folder,
 * calls td_kind_refuse. If that fails, its status and error are returned; otherwise `status` and the reader's error. */
tides_status td_kind_judge(const char *path, int wanted, tides_status status, tides_error *error);

#endif
