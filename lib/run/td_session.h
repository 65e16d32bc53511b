/* Internal: a session as session.c opens it and session_run.c runs it, with what it may close. */
#ifndef TD_SESSION_H
#define TD_SESSION_H

#include "events/td_event_truth.h"
#include "run/td_run.h"
#include "tides/session.h"

struct tides_session {
    tides_session_facts facts;
    tides_run *run; /* its own, or NULL: the caller's */
    tides_scene *scene;
    tides_trajectory *camera;
    tides_frames *frames;
    td_opening opening;               /* its notes are the session's */
    int32_t owns_inputs, owns_device; /* 0: those of the session that it varies, the caller's */
    int32_t owns_camera;              /* 1 without owns_inputs: another camera of the rig */
};

/* session.c: TIDES_BAD_ARGUMENT where one of `outputs` (NULL entries count for nothing) would replace what the run reads. */
tides_status td_session_apart(const tides_session *session, const char *const *outputs, size_t count, tides_error *error);

/* session_truth.c: what sensor.truth_columns and _metres ask for; TIDES_BAD_CONFIG where that can't be had. */
tides_status td_session_truth_columns(const tides_session_facts *facts, td_truth_columns *wanted, tides_error *error);

#endif
