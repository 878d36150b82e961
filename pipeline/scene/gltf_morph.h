/* Morph targets of glTF meshes (glTF 2.0, 3.7.2.2): places of vertices as sums of displacements. An
 * animation of their weights gives a surface a shape for each of its keys. Private to
 * pipeline/scene. */
#ifndef GOPURA_PIPELINE_SCENE_GLTF_MORPH_H
#define GOPURA_PIPELINE_SCENE_GLTF_MORPH_H

#include "pipeline/scene/gltf_sampler.h"
#include "pipeline/scene/scenery_maker.h"

/* The targets of a primitive, and the weights that its node and mesh give them. */
struct gltf_morph {
	struct gltf_numbers targets[GLTF_WEIGHTS_MAX];
	float weights[GLTF_WEIGHTS_MAX]; /* at rest */
	uint32_t count;                  /* 0: it is stiff */
};

/* Returns the first channel of the document that animates the weights of a node, and its animation;
 * NULL: none does. */
const struct cJSON *gltf_morph_channel(const struct gltf *gltf, uint32_t node,
				       const struct cJSON **animation);
/* Returns how many targets the mesh of a node has: those of its first primitive. */
uint32_t gltf_morph_count(const struct gltf *gltf, const struct cJSON *node);

/* Gets the targets of a primitive with so many vertices. -EBADMSG with a diagnostic: they are not
 * valid; -EFBIG: over GLTF_WEIGHTS_MAX. */
must_check int gltf_morph_read(struct gltf_morph *out, const struct gltf *gltf,
			       const struct cJSON *node, const struct cJSON *mesh,
			       const struct cJSON *primitive, uint32_t vertex_count);
/* Adds to a vertex what the targets give it by these weights. */
void gltf_morph_place(float position[3], const struct gltf_morph *morph, const float *weights,
		      uint32_t vertex);
/* Adds the surface of a primitive whose weights a sampler animates; soup has its triangles and
 * their vertices. Errors as scenery_add_bent; -EBADMSG also for places that are no numbers. */
must_check int gltf_morph_add(struct scenery_maker *maker, uint32_t node,
			      const struct scenery_material *material, const struct soup *soup,
			      float crease_rad, const struct scenery_paint *paint,
			      const struct gltf_morph *morph, const struct gltf_numbers *positions,
			      const struct gltf_sampler *sampler);

#endif
