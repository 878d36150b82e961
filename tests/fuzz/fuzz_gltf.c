/* A glTF scene, .gltf or .glb, which may name itself as its buffer: it is refused with its name, or
 * becomes scenery; or views, whose times ascend. */
#include <errno.h>

#include "pipeline/scene/gltf_scenery.h"
#include "pipeline/scene/gltf_views.h"
#include "tests/fuzz/scratch.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static int open_beside(void *data, const char *name)
{
	return strcmp(name, "other.bin") == 0 ? open(data, O_RDONLY | O_CLOEXEC) : -ENOENT;
}

static void read_views(struct gltf *gltf)
{
	struct diagnostics *others = gltf->diagnostics, diagnostics = { 0 };
	struct scene_views views;

	gltf->diagnostics = &diagnostics;
	if (gltf_views_read(&views, gltf, NULL, NULL) < 0 && diagnostics.error_count == 0)
		abort();
	for (uint32_t i = 1; i < views.count; i++)
		if (views.items[i].time_s < views.items[i - 1].time_s)
			abort();
	scene_views_finish(&views);
	gltf->diagnostics = others;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	const struct scenery_node root = { .parent = SCENERY_NONE,
					   .layer = SCENERY_NONE,
					   .place = scenery_at_rest };
	const struct gltf_choice choice = { .plays_always = size % 2 };
	struct diagnostics diagnostics = { 0 }, warnings = { 0 };
	struct gltf_options options = { .open_file = open_beside };
	struct scenery_maker maker = { 0 };
	struct scenery made = { 0 };
	struct gltf gltf;
	uint32_t node = 0;
	int rc;

	scratch_begin();
	scratch_write("other.bin", data, size);
	options.data = (void *)scratch_path("other.bin");
	rc = gltf_read(&gltf, (struct bytes){ data, size }, "a.gltf", &options, &diagnostics);
	if (rc == 0)
		read_views(&gltf);
	if (rc == 0)
		rc = scenery_add_node(&maker, &root, &node);
	if (rc == 0)
		rc = gltf_scenery_add(&maker, &gltf, node, &choice, &warnings);
	if (rc < 0 && !strstr(diagnostics.first.text, "a.gltf"))
		abort();
	if (rc == 0 && scenery_maker_end(&maker, &made) == 0)
		(void)scenery_is_sane(&made); /* numbers may be too large */
	scenery_maker_finish(&maker);
	scenery_finish(&made);
	gltf_finish(&gltf);
	return 0;
}
