/* Internal: the struct of a session, and which of its objects it owns. */
#ifndef TD_SESSION_H
#define TD_SESSION_H

#include "events/td_event_truth.h"
#include "run/td_run.h"
#include "tides/session.h"

struct tides_session {
    tides_session_facts facts;
    tides_run *run; /* owned, or NULL: the caller's */
    tides_scene *scene;
    tides_trajectory *camera;
    tides_frames *frames;
    td_opening opening;               /* its notes are owned */
    int32_t owns_inputs, owns_device; /* 0: they belong to the session that this one varies, or to the caller */
    int32_t owns_camera;              /* 1 without owns_inputs: another camera of the rig */
};

/* TIDES_BAD_ARGUMENT if one of `outputs` (may hold NULL entries) would replace a file that the run reads. */
tides_status td_session_apart(const tides_session *session, const char *const *outputs, size_t count, tides_error *error);

/* The truth columns that sensor.truth_columns and _metres request; TIDES_BAD_CONFIG if they are impossible. */
tides_status td_session_truth_columns(const tides_session_facts *facts, td_truth_columns *wanted, tides_error *error);

#endif
