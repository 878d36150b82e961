/* Puts pipeline/samples/pieces.h before a model. */
#include "curator/view/kept_model.h"

#include <errno.h>
#include <stdlib.h>

#include "pipeline/samples/pieces.h"

struct kept_model {
	struct model model;    /* first; its pieces are those of inner */
	struct model *inner;   /* owned */
	struct pieces *pieces; /* owned */
};

static uint32_t choose(const struct model *base, const float eye_m[3], float detail_rad,
		       uint32_t *pieces)
{
	return model_choose(((const struct kept_model *)base)->inner, eye_m, detail_rad, pieces);
}

static int load(struct model *base, uint32_t piece, struct model_mesh *out)
{
	return pieces_get(((struct kept_model *)base)->pieces, piece, out);
}

static void destroy(struct model *base)
{
	struct kept_model *kept = (struct kept_model *)base;

	pieces_destroy(kept->pieces);
	model_destroy(kept->inner);
	free(kept);
}

int kept_model_create(struct model **out, struct model *inner)
{
	static const struct model_methods methods = { choose, load, destroy };
	struct kept_model *kept = calloc(1, sizeof(*kept));
	int rc = kept ? pieces_create(&kept->pieces, inner) : -ENOMEM;

	*out = NULL;
	if (rc < 0) {
		free(kept);
		model_destroy(inner);
		return rc;
	}
	kept->model = *inner;
	kept->model.methods = &methods;
	kept->inner = inner;
	*out = &kept->model;
	return 0;
}
