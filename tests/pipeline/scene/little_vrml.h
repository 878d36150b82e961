/* A VRML scene that is one text, as scenery. */
#ifndef GOPURA_TESTS_PIPELINE_SCENE_LITTLE_VRML_H
#define GOPURA_TESTS_PIPELINE_SCENE_LITTLE_VRML_H

#include <string.h>

#include "pipeline/scene/vrml_scenery.h"
#include "tests/check.h"

/* Reads it, as a.wrl, with these looks (NULL: none) and puts it below one root; what vrml_read or
 * vrml_scenery_add returns. On success *out is sane and the caller's to finish; otherwise empty. */
static int little_vrml_make(struct scenery *out, const char *text,
			    const struct vrml_options *options, struct scenery_look *looks,
			    uint32_t look_count, struct diagnostics *diagnostics,
			    struct diagnostics *warnings)
{
	const struct scenery_node root = { .parent = SCENERY_NONE,
					   .layer = SCENERY_NONE,
					   .place = scenery_at_rest };
	const struct bytes bytes = { (const uint8_t *)text, strlen(text) };
	struct scenery_maker maker = { .looks = looks, .look_count = look_count };
	struct vrml *scene = NULL;
	uint32_t node = 0;
	int rc = vrml_read(&scene, bytes, "a.wrl", options, diagnostics, warnings);

	*out = (struct scenery){ 0 };
	CHECK(scenery_add_node(&maker, &root, &node) == 0);
	if (rc == 0)
		rc = vrml_scenery_add(&maker, scene, node, options, diagnostics, warnings);
	if (rc == 0)
		CHECK(scenery_maker_end(&maker, out) == 0 && scenery_is_sane(out));
	scenery_maker_finish(&maker);
	vrml_destroy(scene);
	return rc;
}

#endif
