/* The file of a deformation. It is refused with its name, or every number of it is in its range,
 * and its lattices can be made. */
#include <math.h>

#include "geometry/nurbs.h"
#include "pipeline/deform/lattice_step.h"
#include "tests/fuzz/scratch.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static void check_move(const struct deform_step *step, const struct deform_move *move)
{
	for (int k = 0; k < 3; k++)
		if (move->first[k] < -1 || move->last[k] < move->first[k] ||
		    move->last[k] > (int)(step->cells[k] << move->level) + 1 ||
		    !isfinite(move->place[k]))
			abort();
}

static void check_surface(const struct deform_surface *surface)
{
	for (uint32_t i = 0; i < 3 * surface->count[0] * surface->count[1]; i++)
		if (!isfinite(surface->points[i]))
			abort();
	for (int k = 0; k < 2; k++) {
		const struct nurbs_axis axis = { surface->order[k], surface->count[k],
						 surface->knots[k] };

		if (nurbs_axis_fault(&axis))
			abort();
	}
}

static void check_step(const struct deform_step *step)
{
	static const double zero[3] = { 0, 0, 0 }, one[3] = { 1, 1, 1 };
	struct control_lattice lattice;

	if (step->surface.count[0] > 0) {
		check_surface(&step->surface);
		return;
	}
	for (uint32_t i = 0; i < step->move_count; i++)
		check_move(step, &step->moves[i]);
	if (step->cells[0] * step->cells[1] * step->cells[2] > 64 || step->move_count > 16)
		return; /* larger ones take longer, and do nothing else */
	if (lattice_step_make(&lattice, step, step->has_box ? step->low : zero,
			      step->has_box ? step->high : one) < 0)
		abort();
	control_lattice_finish(&lattice);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	struct diagnostics diagnostics = { 0 };
	struct deform_plan plan;
	char path[128];
	int rc;

	scratch_begin();
	scratch_write("bend.json", data, size);
	snprintf(path, sizeof(path), "%s", scratch_path("bend.json"));
	rc = deform_plan_read(&plan, path, &diagnostics);
	if (rc < 0 && strncmp(diagnostics.first.text, path, strlen(path)) != 0)
		abort();
	if (rc == 0 && (plan.step_count == 0 || plan.step_count > DEFORM_STEPS_MAX))
		abort();
	for (uint32_t i = 0; rc == 0 && i < plan.step_count; i++)
		check_step(&plan.steps[i]);
	deform_plan_finish(&plan);
	return 0;
}
