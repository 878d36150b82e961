/* The pictures of a glTF material (glTF 2.0, 3.9.2 and 3.9.3) and where they lie
 * (KHR_texture_transform). Private to pipeline/scene. */
#ifndef GOPURA_PIPELINE_SCENE_GLTF_PAINT_H
#define GOPURA_PIPELINE_SCENE_GLTF_PAINT_H

#include "pipeline/scene/gltf.h"
#include "pipeline/scene/scenery_maker.h"

/* Which numbers of a vertex say where a picture lies, and what is done to them. */
struct gltf_lay {
	char coordinates[24]; /* "TEXCOORD_0" */
	float offset[2], turn_rad, scale[2];
};

struct gltf_paint {
	const struct cJSON *picture, *normals; /* textures of the document; NULL: none */
	float depth;                           /* scale of the normal map */
	struct gltf_lay lay;                   /* of both */
};

/* Gets the pictures of a material. A normal map that lies otherwise than the picture is left out
 * with a warning. -EBADMSG with a diagnostic: the numbers are none. */
must_check int gltf_paint_get(struct gltf_paint *out, const struct gltf *gltf,
			      const struct cJSON *material, struct diagnostics *warnings);
/* Sets uv, as the file has it, to where the pictures lie; v = 0 is their top. */
void gltf_paint_place(float uv[2], const struct gltf_lay *lay);

/* The pictures that were read last, because neighbours share them. Zeroed is empty. */
struct gltf_pictures {
	struct gltf_picture {
		const struct cJSON *of;
		float depth;
		struct picture picture; /* zeroed: it could not be read */
	} colours, normals;
};

/* Reads the pictures; one that cannot be read is a warning and left out. *out is borrowed until the
 * next call. -ENOMEM. */
must_check int gltf_pictures_get(struct gltf_pictures *pictures, struct scenery_paint *out,
				 const struct gltf *gltf, const struct gltf_paint *paint,
				 struct diagnostics *warnings);
void gltf_pictures_finish(struct gltf_pictures *pictures); /* zeroed is fine */

#endif
