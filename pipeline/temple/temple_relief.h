/* Carving: how far a stone surface stands out at a place, in metres. Pure functions of the place,
 * the style and its seed. */
#ifndef GOPURA_PIPELINE_TEMPLE_TEMPLE_RELIEF_H
#define GOPURA_PIPELINE_TEMPLE_TEMPLE_RELIEF_H

#include "base/compiler.h"

#include <stdbool.h>
#include <stdint.h>

enum relief {
	RELIEF_PLAIN,
	RELIEF_SHEET,     /* the relief of the sheet (profiles only) */
	RELIEF_ROUND,     /* a torus moulding (convex) */
	RELIEF_HOLLOW,    /* a cavetto moulding (concave) */
	RELIEF_PETALS,    /* a row of lotus petals, tips up */
	RELIEF_DROPS,     /* the same with tips down */
	RELIEF_BEADS,     /* a row of half spheres */
	RELIEF_FLOWERS,   /* a field of four-petalled flowers in lozenges */
	RELIEF_SCROLL,    /* foliage scrolls along a band */
	RELIEF_SCROLL_UP, /* foliage scrolls climbing a pilaster */
	RELIEF_DEVATA,    /* a standing goddess in her niche */
	RELIEF_MARCH,     /* rows of walking figures, as on gallery walls */
	RELIEF_LINTEL,    /* a kala's head over a garland */
	RELIEF_TYMPANUM,  /* a pediment: naga arch, deity, worshippers */
	RELIEF_DOOR,      /* a false door */
	RELIEF_WINDOW,    /* a window closed by turned balusters */
	RELIEF_FACE,      /* a great smiling face */
	RELIEF_LION,      /* the mask of a guardian lion */
	RELIEF_TILES,     /* roof stones carved as tiles */
	RELIEF_FLAME,     /* an antefix */
	RELIEF_HOOD,      /* the seven heads of a naga */
	RELIEF_SCALES,    /* a naga's body */
	RELIEF_BLOCKS,    /* rough masonry, open joints */
};

struct relief_style {
	enum relief kind;
	float depth_m;
	float period_m;
	uint32_t seed;
};

struct relief_place {
	float x_m, y_m;          /* position from the lower left corner of the field */
	float width_m, height_m; /* of the field */
	float shape;             /* share of the width that is left at this height */
	float step_m;            /* distance of vertices: finer motifs fade out */
	uint32_t segment;        /* segment of the outline, so that neighbours differ */
};

/* Returns whether the relief changes along the outline and so needs divisions there. */
bool relief_varies_across(enum relief kind);
/* Returns the height over the sheet at a place, metres; negative in hollows. */
float relief_height(const struct relief_style *style, const struct relief_place *place);

#endif
