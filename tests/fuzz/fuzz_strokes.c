/* Messages of a curator's browser, one a line, carried out on a small view: strokes of every tool,
 * and the part that is found from them. */
#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "curator/select/part_cut.h"
#include "curator/session/request.h"
#include "tests/curator/select/little_view.h"

enum { MESSAGES_MAX = 12 };

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

struct view {
	struct view_image image;
	struct superpixels superpixels;
	uint8_t marks[LITTLE_PIXELS], in_part[LITTLE_PIXELS];
};

static struct view *the_view(void)
{
	static struct view view;

	if (!view.image.colours) {
		view.image = little_view(1, true, true);
		if (superpixels_make(&view.superpixels, &view.image) < 0)
			abort();
	}
	memset(view.marks, MARK_UNKNOWN, sizeof(view.marks));
	return &view;
}

/* As curator/session/selection.c works. */
static int carry_out(struct view *view, const struct request *request)
{
	const struct stroke stroke = { .points_px = (const float(*)[2])request->points_px,
				       .count = request->point_count,
				       .width_px = request->width_px };
	const uint8_t *marks = view->marks;
	int rc = 0;

	if (request->kind == REQUEST_STROKE && request->tool <= TOOL_REST &&
	    request->tool != TOOL_LASSO) {
		strokes_paint(view->marks, LITTLE_WIDTH, LITTLE_HEIGHT, &stroke,
			      request->tool == TOOL_PART ? MARK_PART_SEED : MARK_REST_SEED);
		return 1;
	}
	if (request->kind == REQUEST_STROKE && request->tool == TOOL_LASSO)
		return strokes_lasso(view->in_part, LITTLE_WIDTH, LITTLE_HEIGHT, &stroke) < 0;
	if (request->kind == REQUEST_STROKE) {
		rc = strokes_heavy_lasso(view->in_part, LITTLE_WIDTH, LITTLE_HEIGHT, &stroke);
		marks = view->in_part;
	} else if (request->kind != REQUEST_APPLY) {
		return 1;
	}
	return rc == 0 ? part_cut(view->in_part, marks, &view->image, &view->superpixels) : rc;
}

/* Whether each pixel is in the part or not, and the sky in none. */
static void check(const struct view *view)
{
	for (size_t i = 0; i < LITTLE_PIXELS; i++)
		if (view->in_part[i] > 1 || (view->image.inverse_m[i] <= 0 && view->in_part[i]))
			abort();
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	struct view *view = the_view();
	const char *text = (const char *)data, *end = text + size;

	for (int n = 0; n < MESSAGES_MAX && text < end; n++) {
		const char *next = memchr(text, '\n', (size_t)(end - text));
		const size_t bytes = (size_t)((next ? next : end) - text);
		char problem[REQUEST_PROBLEM_BYTES];
		struct request request;

		if (request_parse(&request, text, bytes, problem) == 0 &&
		    carry_out(view, &request) == 0 &&
		    !(request.kind == REQUEST_STROKE && request.tool == TOOL_LASSO))
			check(view);
		request_finish(&request);
		text += bytes + 1;
	}
	return 0;
}
