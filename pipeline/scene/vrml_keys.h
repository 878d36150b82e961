/* The keys of an interpolator. Private to pipeline/scene. */
#ifndef GOPURA_PIPELINE_SCENE_VRML_KEYS_H
#define GOPURA_PIPELINE_SCENE_VRML_KEYS_H

#include "base/diagnostics.h"
#include "pipeline/scene/vrml.h"

/* Gets the keys and the values, of `width` numbers each, of an interpolator. -EBADMSG, with a
 * diagnostic: they do not fit together. */
must_check int vrml_keys(const struct vrml_node *interpolator, uint32_t width,
			 const struct vrml_value **keys, const struct vrml_value **values,
			 struct diagnostics *diagnostics);

#endif
