/* TIDES: event cameras in continuous time from dynamic Gaussian-splatting scenes.
 *
 * Conventions, everywhere:
 *   time                seconds (double) in calls, integer nanoseconds in events
 *   _dot                d/dt, per second; a dual is (value, time derivative)
 *   world               right-handed; camera axes are OpenCV's: x right, y down, z forward
 *   matrices            row-major, column vectors; quaternions wxyz; angles in radians
 *   pixels              (0, 0) top left, its centre at (0.5, 0.5); images are (height x width), row 0 on top
 *   polarity            +1 or -1
 *   structs             start from their *_defaults function where they have one; it sets `size`. A shorter struct, of an older
 *                       caller, is completed with defaults; a longer one is fine where all that is new in it is 0
 * Read the headers in the order below: it is the order of the pipeline. */
#ifndef TIDES_H
#define TIDES_H

#include "tides/base.h"
#include "tides/dataset.h"
#include "tides/device.h"
#include "tides/trajectory.h"
#include "tides/imu.h"
#include "tides/motion.h"
#include "tides/scene.h"
#include "tides/camera.h"
#include "tides/generate.h"
#include "tides/render.h"
#include "tides/exposure.h"
#include "tides/truth.h"
#include "tides/sensor.h"
#include "tides/simulate.h"
#include "tides/frames.h"
#include "tides/baselines.h"
#include "tides/events.h"
#include "tides/readout.h"
#include "tides/filters.h"
#include "tides/convert.h"
#include "tides/image.h"
#include "tides/metrics.h"
#include "tides/representations.h"
#include "tides/page.h"
#include "tides/run.h"
#include "tides/inputs.h"
#include "tides/session.h"
#include "tides/live.h"
#include "tides/measure.h"

#endif
