/* The image's decisions as code asks for them: a literal where a program is built for one (TD_BUILD_...;
 * lib/render/opencl_build.c lists them), else the image's value. Code that is switched off then comes no further than the
 * compiler's front end. Left to its optimiser, such code took twice as long to build. PoCL also lays out a work-item's
 * variables in memory before it unrolls loops: a struct with an array that a loop goes through stays there, whether or not
 * the loop is ever reached. TD_BUILT takes the image's size, so that compilers count the image as used. */
#ifndef TD_CHOICES_H
#define TD_CHOICES_H

#if defined(TD_OPENCL) && defined(__clang__) /* clang finds a condition that is a literal's worth a word */
#pragma clang diagnostic ignored "-Wconstant-logical-operand"
#endif

#define TD_BUILT(image, what) ((int)(sizeof *(image) > 0) * (what))

#ifdef TD_BUILD_SH_DEGREE
#define td_sh_degree(image) TD_BUILT(image, TD_BUILD_SH_DEGREE)
#else
#define td_sh_degree(image) ((image)->sh_degree)
#endif

#ifdef TD_BUILD_ANTIALIAS
#define td_antialias(image) TD_BUILT(image, TD_BUILD_ANTIALIAS)
#else
#define td_antialias(image) ((image)->antialias)
#endif

#ifdef TD_BUILD_CUT_RULE
#define td_cut_rule(image) TD_BUILT(image, TD_BUILD_CUT_RULE)
#else
#define td_cut_rule(image) ((image)->cut_rule)
#endif

#ifdef TD_BUILD_STOP_RULE
#define td_stop_rule(image) TD_BUILT(image, TD_BUILD_STOP_RULE)
#else
#define td_stop_rule(image) ((image)->stop_rule)
#endif

#ifdef TD_BUILD_EXTENT_RULE
#define td_extent_rule(image) TD_BUILT(image, TD_BUILD_EXTENT_RULE)
#else
#define td_extent_rule(image) ((image)->extent_rule)
#endif

#ifdef TD_BUILD_MOVING
#define td_moving(image) TD_BUILT(image, TD_BUILD_MOVING)
#else
#define td_moving(image) ((image)->moving)
#endif

#ifdef TD_BUILD_OUTPUTS
#define td_outputs(image) TD_BUILT(image, TD_BUILD_OUTPUTS)
#else
#define td_outputs(image) ((image)->outputs)
#endif

#ifdef TD_BUILD_SOFT_ORDER
#define td_soft_order(image) TD_BUILT(image, TD_BUILD_SOFT_ORDER)
#else
#define td_soft_order(image) ((image)->soft_order)
#endif

#ifdef TD_BUILD_DECODER
#define td_decoder(image) TD_BUILT(image, TD_BUILD_DECODER)
#else
#define td_decoder(image) ((image)->decoder)
#endif

#ifdef TD_BUILD_LENS
#define td_lens_model(image) TD_BUILT(image, TD_BUILD_LENS)
#else
#define td_lens_model(image) ((image)->lens_model)
#endif

#ifdef TD_BUILD_CODED
#define td_is_coded(image) TD_BUILT(image, TD_BUILD_CODED)
#else
#define td_is_coded(image) ((image)->is_coded)
#endif

#ifdef TD_BUILD_COLOURS_MOVE
#define td_colours_move(image) TD_BUILT(image, TD_BUILD_COLOURS_MOVE)
#else
#define td_colours_move(image) ((image)->colours_move)
#endif

#define td_with_diagnostics(image) (td_outputs(image) >= TD_OUT_DIAGNOSTICS)
#define td_with_colour(image) (td_outputs(image) >= TD_OUT_COLOUR)
#define td_with_rates(image) (td_outputs(image) != TD_OUT_LUMINANCE)
#define td_with_decoder(image) (td_decoder(image) != 0)
/* The quantities composited without a decoder: luminance, and colour beside it; where light isn't linear in colours, three
 * channels by themselves (channels.h). */
#define td_with_luminance(image) (!td_with_decoder(image) && !td_is_coded(image))
#define td_with_channels(image) (!td_with_decoder(image) && td_with_colour(image) && !td_is_coded(image))
#define td_by_channels(image) (!td_with_decoder(image) && td_is_coded(image))
/* 1 where record paths have red, green and blue by themselves, before their clamp at 0: light isn't linear in them, or they
 * depend on the direction or the time, so that a clamp may begin or end. */
#define td_paths_by_channels(image) (td_is_coded(image) || td_sh_degree(image) > 0 || td_colours_move(image))

#endif
