/* Divides a sheet into rows and columns at a density, and computes the position of each vertex. */
#include "pipeline/temple/temple_sheet.h"

#include <math.h>

static const float turn_rad = 6.2831853f;

bool sheet_wraps(const struct sheet *sheet)
{
	return sheet->outline->kind != OUTLINE_LINE;
}

static uint32_t outline_segments(const struct temple_outline *outline)
{
	return outline->kind == OUTLINE_CLOSED ? outline->count : 1;
}

static float across_length_m(const struct sheet *sheet, uint32_t segment)
{
	const struct temple_outline *o = sheet->outline;
	const float *a = o->corners[segment], *b = o->corners[(segment + 1) % o->count];

	if (o->kind == OUTLINE_LINE)
		return sheet->size_m;
	if (o->kind == OUTLINE_ROUND)
		return turn_rad * sheet->size_m;
	return hypotf(b[0] - a[0], (b[1] - a[1]) * sheet->stretch) * sheet->size_m;
}

static float up_length_m(const struct sheet *sheet, uint32_t segment)
{
	const struct profile_point *p = &sheet->profile->points[segment];

	return hypotf((p[1].out - p[0].out) * sheet->reach_m, (p[1].z - p[0].z) * sheet->height_m);
}

static struct relief_style style_of(const struct sheet *sheet, uint32_t segment)
{
	const struct profile_point *p = &sheet->profile->points[segment];

	if (p->relief == RELIEF_SHEET)
		return sheet->relief;
	return (struct relief_style){ p->relief, p->depth_m, p->period_m, sheet->relief.seed };
}

static bool carved_across(const struct sheet *sheet)
{
	for (uint32_t s = 0; s + 1 < sheet->profile->count; s++)
		if (relief_varies_across(style_of(sheet, s).kind))
			return true;
	return false;
}

/* Returns the number of divisions of a segment; 0: too short to show, leave out its end. */
static uint32_t divisions(float length_m, float density, bool carved, bool curved)
{
	float wanted = length_m * density;

	if (wanted < 0.35f)
		return 0;
	if (carved)
		return (uint32_t)fmaxf(1.0f, roundf(wanted));
	if (curved)
		return (uint32_t)fminf(12.0f, fmaxf(1.0f, roundf(wanted * 1.5f)));
	return 1;
}

struct list {
	struct station *stations; /* NULL: only count */
	uint32_t count, most;
	float step_m;
};

static void list_add(struct list *list, uint32_t segment, float at, int rim)
{
	if (list->stations && list->count < list->most)
		list->stations[list->count] =
			(struct station){ (uint16_t)segment, (int8_t)rim, at, list->step_m };
	list->count++;
}

static void list_segment(struct list *list, uint32_t segment, uint32_t parts)
{
	for (uint32_t i = 1; i <= parts; i++)
		list_add(list, segment, (float)i / (float)parts, 0);
}

static void list_across(const struct sheet *sheet, float density, struct list *list)
{
	uint32_t segments = outline_segments(sheet->outline);
	bool round = sheet->outline->kind == OUTLINE_ROUND;
	bool carved = carved_across(sheet);

	if (!sheet_wraps(sheet)) {
		if (sheet->rim_m > 0)
			list_add(list, 0, 0.0f, -1);
		list_add(list, 0, 0.0f, 0);
	}
	for (uint32_t s = 0; s < segments; s++) {
		float length = across_length_m(sheet, s);
		uint32_t parts = divisions(length, density, carved, false);
		if (round) {
			float smooth = fmaxf(5.0f, fminf(24.0f, length * density));
			parts = (uint32_t)fmaxf((float)parts, smooth);
		}
		if (!sheet_wraps(sheet) && parts == 0)
			parts = 1;
		list_segment(list, s, parts);
	}
	if (!sheet_wraps(sheet) && sheet->rim_m > 0)
		list_add(list, 0, 1.0f, 1);
	/* A ring with fewer than four corners encloses no volume: keep all of them. */
	if (sheet_wraps(sheet) && list->count < 4) {
		list->count = 0;
		for (uint32_t s = 0; s < segments; s++)
			list_segment(list, s, 1);
	}
}

static void list_up(const struct sheet *sheet, float density, struct list *list)
{
	uint32_t segments = sheet->profile->count - 1;
	const struct profile_point *first = sheet->profile->points, *last = first + segments;
	/* a closed profile must stay closed */
	bool returns = first->out == last->out && first->z == last->z;
	bool rim = !sheet_wraps(sheet) && sheet->rim_m > 0;

	if (rim)
		list_add(list, 0, 0.0f, -1);
	list_add(list, 0, 0.0f, 0);
	for (uint32_t s = 0; s < segments; s++) {
		enum relief kind = style_of(sheet, s).kind;
		bool carved = relief_varies_across(kind);
		uint32_t parts =
			divisions(up_length_m(sheet, s), density, carved, kind != RELIEF_PLAIN);
		if (parts == 0 && (s + 1 == segments || returns))
			parts = 1;
		list_segment(list, s, parts);
	}
	if (rim)
		list_add(list, segments - 1, 1.0f, 1);
}

void sheet_stations(const struct sheet *sheet, float density, struct station *across,
		    uint32_t *columns, struct station *up, uint32_t *rows, uint32_t most)
{
	struct list u = { across, 0, most, 0 }, v = { up, 0, most, 0 };
	float width = 0, height = 0;
	float fine = density * sheet->interest;

	u.step_m = v.step_m = 1 / fine;

	for (uint32_t s = 0; s < outline_segments(sheet->outline); s++)
		width += across_length_m(sheet, s);
	for (uint32_t s = 0; s + 1 < sheet->profile->count; s++)
		height += up_length_m(sheet, s);
	if (!sheet->optional || sqrtf(width * height) * fine >= 2.0f) {
		list_across(sheet, fine, &u);
		list_up(sheet, fine, &v);
	}
	*columns = u.count;
	*rows = v.count;
}

uint64_t sheet_vertices(const struct sheet *sheet, uint32_t columns, uint32_t rows)
{
	(void)sheet;
	return (uint64_t)columns * rows;
}

uint64_t sheet_triangles(const struct sheet *sheet, uint32_t columns, uint32_t rows)
{
	if (columns == 0 || rows == 0)
		return 0;
	return 2ull * (sheet_wraps(sheet) ? columns : columns - 1) * (rows - 1);
}

/* ---- position of a vertex */

/* Returns the width at height t (0..1) as a share of the full width. */
static float shape_width(enum sheet_shape shape, float t)
{
	switch (shape) {
	case SHAPE_FULL:
		return 1.0f;
	case SHAPE_PEDIMENT: /* a pointed arch with small lobes */
		return fmaxf(0.03f, powf(1.0f - t, 0.62f) * (1.0f + 0.05f * sinf(t * 22.0f)));
	case SHAPE_LEAF:
		return t < 0.3f ? 0.8f + 0.2f * sinf(t * 5.236f)
				: fmaxf(0.05f, powf(fmaxf(0.0f, cosf((t - 0.3f) * 2.244f)), 0.85f));
	case SHAPE_HOOD:
		return t < 0.7f ? 0.36f + 0.64f * sinf(t / 0.7f * 1.5708f)
				: fmaxf(0.12f, sqrtf(1.0f - (t - 0.7f) * (t - 0.7f) / 0.0905f));
	}
	return 1.0f;
}

/* Computes the offset at a corner that moves both edges outwards by one metre. */
static void mitre(const struct temple_outline *o, uint32_t corner, float out[2])
{
	const float *a = o->corners[(corner + o->count - 1) % o->count];
	const float *b = o->corners[corner], *c = o->corners[(corner + 1) % o->count];
	float l1 = hypotf(b[0] - a[0], b[1] - a[1]), l2 = hypotf(c[0] - b[0], c[1] - b[1]);
	float n1[2] = { (b[1] - a[1]) / l1, (a[0] - b[0]) / l1 };
	float n2[2] = { (c[1] - b[1]) / l2, (b[0] - c[0]) / l2 };
	float scale = 1.0f / (1.0f + n1[0] * n2[0] + n1[1] * n2[1]);

	out[0] = (n1[0] + n2[0]) * scale;
	out[1] = (n1[1] + n2[1]) * scale;
}

/* Base point, unit outward normal and mitred offset in the plan. */
struct foot {
	float point[2], outside[2], offset[2];
};

static void foot_at(const struct sheet *sheet, const struct station *across, float width,
		    struct foot *foot)
{
	const struct temple_outline *o = sheet->outline;
	uint32_t next = (across->segment + 1) % o->count;
	const float *a = o->corners[across->segment], *b = o->corners[next];
	float t = across->at, from[2], to[2], angle = t * turn_rad;

	*foot = (struct foot){ .outside = { 0, -1 }, .offset = { 0, -1 } };
	switch (o->kind) {
	case OUTLINE_LINE:
		foot->point[0] = (t - 0.5f) * sheet->size_m * width;
		break;
	case OUTLINE_ROUND:
		foot->outside[0] = foot->offset[0] = cosf(angle);
		foot->outside[1] = foot->offset[1] = sinf(angle);
		foot->point[0] = foot->outside[0] * sheet->size_m;
		foot->point[1] = foot->outside[1] * sheet->size_m;
		break;
	case OUTLINE_CLOSED:
		mitre(o, across->segment, from);
		mitre(o, next, to);
		for (int k = 0; k < 2; k++) {
			foot->point[k] = (a[k] + (b[k] - a[k]) * t) * sheet->size_m *
					 (k ? sheet->stretch : 1.0f);
			foot->offset[k] = from[k] + (to[k] - from[k]) * t;
		}
		float length = hypotf(b[0] - a[0], b[1] - a[1]);
		foot->outside[0] = (b[1] - a[1]) / length;
		foot->outside[1] = (a[0] - b[0]) / length;
		break;
	}
}

/* Returns the relief of a vertex in metres outwards; *style is the style there. */
static float relief_of(const struct sheet *sheet, const struct station *across,
		       const struct station *up, float width, struct relief_style *style)
{
	*style = style_of(sheet, up->segment);
	struct relief_place place = {
		.x_m = across->at * across_length_m(sheet, across->segment),
		.y_m = up->at * up_length_m(sheet, up->segment),
		.width_m = across_length_m(sheet, across->segment),
		.height_m = up_length_m(sheet, up->segment),
		.shape = width,
		.step_m = across->step_m,
		.segment = across->segment,
	};
	return relief_height(style, &place);
}

void sheet_at(const struct sheet *sheet, const struct station *across, const struct station *up,
	      float position_m[3], float *hollow)
{
	const struct profile_point *p = &sheet->profile->points[up->segment];
	float t = up->at, top = sheet->profile->points[sheet->profile->count - 1].z;
	float z = (p[0].z + (p[1].z - p[0].z) * t) * sheet->height_m;
	float out = (p[0].out + (p[1].out - p[0].out) * t) * sheet->reach_m;
	float width = shape_width(sheet->shape, top != 0 ? z / (top * sheet->height_m) : 0);
	struct relief_style style;
	struct foot foot;
	float height = relief_of(sheet, across, up, width, &style);
	float length = up_length_m(sheet, up->segment);
	float face_out = (p[1].z - p[0].z) * sheet->height_m / length;
	float face_up = -(p[1].out - p[0].out) * sheet->reach_m / length;
	bool mitred = !relief_varies_across(style.kind);

	foot_at(sheet, across, width, &foot);
	*hollow = style.depth_m > 0 ? fminf(1.0f, fmaxf(0.0f, 1.0f - height / style.depth_m)) : 0;
	if (across->rim || up->rim)
		height = -sheet->rim_m;
	out += z * sheet->lean;
	if (mitred)
		out += height * face_out;
	float side = across->rim * 0.3f * sheet->rim_m;
	float x = foot.point[0] + foot.offset[0] * out + side;
	float y = foot.point[1] + foot.offset[1] * out;
	if (!mitred) {
		x += foot.outside[0] * height * face_out;
		y += foot.outside[1] * height * face_out;
	}
	z += height * face_up + up->rim * 0.3f * sheet->rim_m;
	position_m[0] = sheet->origin_m[0] + sheet->turn[0] * x - sheet->turn[1] * y;
	position_m[1] = sheet->origin_m[1] + sheet->turn[1] * x + sheet->turn[0] * y;
	position_m[2] = sheet->origin_m[2] + z;
}
