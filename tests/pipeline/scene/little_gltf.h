/* A glTF document that is one text: numbers, which are its one buffer, and lists. */
#ifndef GOPURA_TESTS_PIPELINE_SCENE_LITTLE_GLTF_H
#define GOPURA_TESTS_PIPELINE_SCENE_LITTLE_GLTF_H

#include <sodium.h>
#include <stdio.h>
#include <string.h>

#include "pipeline/scene/gltf.h"
#include "tests/check.h"

enum { LITTLE_GLTF_BYTES = 8192 };

/* Reads it, as a.gltf; what gltf_read returns. */
static int little_gltf_read(struct gltf *out, const void *numbers, size_t bytes, const char *lists,
			    struct diagnostics *diagnostics)
{
	const struct gltf_options options = { 0 };
	char base64[512], text[LITTLE_GLTF_BYTES];

	sodium_bin2base64(base64, sizeof(base64), numbers, bytes, sodium_base64_VARIANT_ORIGINAL);
	CHECK(snprintf(text, sizeof(text),
		       "{\"asset\": {\"version\": \"2.0\"},\n\"buffers\": [{\"byteLength\": %zu, "
		       "\"uri\": \"data:application/octet-stream;base64,%s\"}],\n%s}",
		       bytes, base64, lists) < LITTLE_GLTF_BYTES);
	return gltf_read(out, (struct bytes){ (const uint8_t *)text, strlen(text) }, "a.gltf",
			 &options, diagnostics);
}

#endif
