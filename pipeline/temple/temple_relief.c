/* Mouldings, ornaments and masonry as height functions, and the choice of the function by style. */
#include "pipeline/temple/temple_relief.h"

#include "pipeline/temple/temple_carve.h"
#include "pipeline/temple/temple_doors.h"
#include "pipeline/temple/temple_figures.h"
#include "pipeline/temple/temple_heads.h"

#include <math.h>

bool relief_varies_across(enum relief kind)
{
	return kind != RELIEF_PLAIN && kind != RELIEF_ROUND && kind != RELIEF_HOLLOW;
}

/* Position in a repeated motif: x is -0.5..0.5 of it, and its width is chosen so that whole motifs
 * fit. */
struct cell {
	float x, width_m;
	uint32_t index;
};

static struct cell cell_at(float x_m, float width_m, float period_m, float shift)
{
	float count = fmaxf(1.0f, roundf(width_m / fmaxf(period_m, 0.01f)));
	float at = x_m / width_m * count + shift;
	float whole = floorf(at);

	return (struct cell){ at - whole - 0.5f, width_m / count, (uint32_t)(int32_t)whole };
}

static float petal(float x, float y)
{
	float half = 0.5f * sqrtf(fmaxf(0.0f, 1.0f - y * y * y));
	float across = half > 0 ? fabsf(x) / half : 2.0f;

	if (across >= 1)
		return 0;
	float body = sqrtf(1 - across * across) * (0.55f + 0.45f * sqrtf(y));
	float inner = fabsf(across - 0.72f) < 0.1f ? -0.16f : 0;
	return body + inner + 0.12f * carve_ridge(x, 0.07f);
}

static float petals(const struct relief_style *s, const struct relief_place *p, bool down)
{
	float y = p->y_m / p->height_m;
	struct cell front = cell_at(p->x_m, p->width_m, s->period_m, 0);
	struct cell back = cell_at(p->x_m, p->width_m, s->period_m, 0.5f);

	if (down)
		y = 1 - y;
	return fmaxf(petal(front.x, y), 0.55f * petal(back.x, y));
}

static float beads(const struct relief_style *s, const struct relief_place *p)
{
	struct cell c = cell_at(p->x_m, p->width_m, fmaxf(s->period_m, p->height_m), 0);
	float x = c.x * c.width_m / p->height_m, y = p->y_m / p->height_m - 0.5f;
	float far2 = (x * x + y * y) / 0.2f;

	return far2 < 1 ? sqrtf(1 - far2) : 0;
}

static float flower(float x, float y)
{
	float r = hypotf(x, y) * 2, a = atan2f(y, x);
	float lobe = 0.62f + 0.34f * fabsf(cosf(2 * a));
	float leaf = r < lobe ? sqrtf(1 - r / lobe) * (0.75f + 0.25f * cosf(8 * a)) : 0;

	return fmaxf(leaf, r < 0.26f ? sqrtf(1 - r * r / 0.0676f) : 0);
}

static float flowers(const struct relief_style *s, const struct relief_place *p)
{
	struct cell cx = cell_at(p->x_m, p->width_m, s->period_m, 0);
	struct cell cy = cell_at(p->y_m, p->height_m, s->period_m, 0);
	float lattice = fminf(fabsf(fabsf(cx.x) + fabsf(cy.x) - 0.5f), 1.0f);

	if (fabsf(cx.x) + fabsf(cy.x) < 0.5f)
		return fmaxf(flower(cx.x * 1.3f, cy.x * 1.3f), 0.7f * carve_ridge(lattice, 0.07f));
	float x = 0.5f - fabsf(cx.x), y = 0.5f - fabsf(cy.x);
	return fmaxf(0.8f * flower(x * 1.5f, y * 1.5f), 0.7f * carve_ridge(lattice, 0.07f));
}

/* A vine waving along the band, with a leafy spiral in each bend. x counts motifs. */
static float scroll(float x, float y)
{
	float cell = floorf(x * 2), side = fmodf(cell, 2) == 0 ? 1.0f : -1.0f;
	float cx = (x * 2 - cell - 0.5f), cy = (y - 0.5f) * 1.05f + side * 0.06f;
	float r = hypotf(cx, cy), a = atan2f(cy * side, cx);
	float stem = carve_ridge(y - 0.5f - 0.36f * side * sinf(3.14159f * (x * 2 - cell)), 0.09f);
	float turns = r * 4.6f - a / 6.28319f;
	float spiral = r < 0.4f ? carve_ridge(turns - roundf(turns), 0.30f) : 0;
	float rim = 0.36f + 0.08f * cosf(7 * a);
	float leaf = r < rim + 0.1f ? 0.8f * carve_ridge(r - rim, 0.11f) : 0;
	float bud = r < 0.1f ? sqrtf(1 - r * r * 100) : 0;

	return fmaxf(fmaxf(stem, leaf), fmaxf(spiral * (1.0f - r), bud));
}

static float scroll_band(const struct relief_style *s, const struct relief_place *p, bool climbing)
{
	float along = climbing ? p->y_m : p->x_m, length = climbing ? p->height_m : p->width_m;
	float across = climbing ? p->x_m / p->width_m : p->y_m / p->height_m;
	float count = fmaxf(1.0f, roundf(length / s->period_m));
	float edge = fminf(across, 1 - across);

	return fmaxf(scroll(along / length * count, (across - 0.5f) * 1.15f + 0.5f) *
			     carve_step(0.02f, 0.1f, edge),
		     0.9f * carve_ridge(edge - 0.045f, 0.045f));
}

static float tiles(const struct relief_style *s, const struct relief_place *p)
{
	struct cell c = cell_at(p->x_m, p->width_m, s->period_m, 0);
	float x = c.x * 2, course = p->y_m / 0.42f, lap = course - floorf(course);

	return 0.42f + 0.42f * cosf(x * 3.14159f) + 0.15f * (1 - lap);
}

static float scales(const struct relief_style *s, const struct relief_place *p)
{
	float row = p->y_m / s->period_m * 1.6f, whole = floorf(row);
	float shift = fmodf(whole, 2) == 0 ? 0 : 0.5f;
	struct cell c = cell_at(p->x_m, p->width_m, s->period_m, shift);
	float y = row - whole, r = c.x * c.x * 4 + (1 - y) * (1 - y);

	return r < 1.2f ? sqrtf(1 - r / 1.2f) : 0.05f;
}

/* Courses of stones with joints, each stone slightly displaced. */
static float blocks(const struct relief_style *s, const struct relief_place *p)
{
	float course_m = s->period_m * 0.55f, row = floorf(p->y_m / course_m);
	float shift = temple_chance(s->seed, (uint32_t)(int32_t)row, 7) * s->period_m;
	float stone = floorf((p->x_m + shift) / s->period_m);
	float x = p->x_m + shift - stone * s->period_m, y = p->y_m - row * course_m;
	float edge = fminf(fminf(x, s->period_m - x), fminf(y, course_m - y));
	uint32_t a = (uint32_t)(int32_t)row, b = (uint32_t)(int32_t)stone;
	float out = 0.55f + 0.45f * temple_chance(s->seed, a, b);
	float tilt = (temple_chance(s->seed + 1, a, b) - 0.5f) * (x / s->period_m - 0.5f);

	return (out + tilt * 0.5f) * carve_step(0.0f, 0.035f, edge);
}

static float carving(const struct relief_style *s, const struct relief_place *p)
{
	float y = p->y_m / p->height_m, aspect = p->width_m / p->height_m;
	float x = (p->x_m / p->width_m - 0.5f) * aspect * p->shape;

	switch (s->kind) {
	case RELIEF_ROUND:
		return sinf(3.14159f * y);
	case RELIEF_HOLLOW:
		return -sinf(3.14159f * y);
	case RELIEF_PETALS:
		return petals(s, p, false);
	case RELIEF_DROPS:
		return petals(s, p, true);
	case RELIEF_BEADS:
		return beads(s, p);
	case RELIEF_FLOWERS:
		return flowers(s, p);
	case RELIEF_SCROLL:
		return scroll_band(s, p, false);
	case RELIEF_SCROLL_UP:
		return scroll_band(s, p, true);
	case RELIEF_DEVATA:
		return figure_devata(x, y, aspect, s->seed + p->segment);
	case RELIEF_MARCH:
		return figure_march(p->x_m, p->y_m, p->height_m, s->seed);
	case RELIEF_LINTEL:
		return figure_lintel(x, y, aspect);
	case RELIEF_TYMPANUM:
		return figure_tympanum(x, y, aspect, p->shape);
	case RELIEF_DOOR:
		return figure_door(x, y, aspect);
	case RELIEF_WINDOW:
		return figure_window(x, y, aspect);
	case RELIEF_FACE:
		return figure_face(x, y, aspect);
	case RELIEF_LION:
		return figure_lion(x, y);
	case RELIEF_TILES:
		return tiles(s, p);
	case RELIEF_FLAME:
		return figure_flame(x, y, aspect, p->shape);
	case RELIEF_HOOD:
		return figure_hood(x, y, aspect);
	case RELIEF_SCALES:
		return scales(s, p);
	case RELIEF_BLOCKS:
		return blocks(s, p);
	case RELIEF_PLAIN:
	case RELIEF_SHEET:
		break;
	}
	return 0;
}

/* Returns the share of a motif that is kept: motifs too fine for the vertices would only be
 * noise. */
static float resolved(const struct relief_style *s, const struct relief_place *p)
{
	float motif_m = s->kind == RELIEF_BEADS ? fmaxf(s->period_m, p->height_m) : s->period_m;

	if (s->period_m <= 0 || s->kind == RELIEF_BLOCKS)
		return 1;
	return carve_step(1.4f, 3.2f, motif_m / p->step_m);
}

float relief_height(const struct relief_style *style, const struct relief_place *place)
{
	if (style->kind == RELIEF_PLAIN || place->height_m <= 0 || place->width_m <= 0)
		return 0;
	float share = resolved(style, place);
	return share > 0 ? share * style->depth_m * carving(style, place) : 0;
}
