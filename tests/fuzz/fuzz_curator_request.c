/* A message of a curator's browser over the WebSocket. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "curator/session/painter.h"
#include "curator/session/request.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static void check(const struct request *request)
{
	const struct camera *camera = &request->camera;

	if (request->kind == REQUEST_CAMERA &&
	    (camera->width_px < PAINTER_SIDE_MIN_PX || camera->width_px > PAINTER_SIDE_MAX_PX ||
	     camera->height_px < PAINTER_SIDE_MIN_PX || camera->height_px > PAINTER_SIDE_MAX_PX ||
	     camera->width_px % 2 || !isfinite(camera->eye_m[0]) || !isfinite(camera->fov_deg)))
		abort();
	if ((request->kind == REQUEST_STROKE || request->kind == REQUEST_PICK) !=
	    (request->point_count > 0))
		abort();
	for (uint32_t n = 0; n < request->point_count; n++)
		if (!isfinite(request->points_px[n][0]) || !isfinite(request->points_px[n][1]))
			abort();
	if (strspn(request->id, "abcdefghijklmnopqrstuvwxyz0123456789-_") != strlen(request->id))
		abort();
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	char problem[REQUEST_PROBLEM_BYTES];
	struct request request;

	if (request_parse(&request, (const char *)data, size, problem) == 0)
		check(&request);
	else if (!*problem || request.points_px)
		abort();
	request_finish(&request);
	return 0;
}
