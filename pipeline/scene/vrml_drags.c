/* Reads the three sensors of ISO/IEC 14772-1 that turn a drag into a place or a turn (6.15, 6.34,
 * 6.44). A sensor's own axes are those of the group that it stands in, which is a node of the
 * scenery. */
#include "pipeline/scene/vrml_drags.h"

#include <errno.h>
#include <math.h>
#include <string.h>

#include "base/compiler.h"
#include "geometry/turn.h"
#include "pipeline/scene/vrml_graph.h"

static const float far = 1e6f; /* limits beyond are mistakes */

static const struct sensor {
	const char *type, *out, *field;
	enum scenery_drag_kind kind;
} sensors[] = {
	{ "PlaneSensor", "translation_changed", "translation", SCENERY_DRAG_PLANE },
	{ "CylinderSensor", "rotation_changed", "rotation", SCENERY_DRAG_CYLINDER },
	{ "SphereSensor", "rotation_changed", "rotation", SCENERY_DRAG_SPHERE },
};

static const struct sensor *sensor_of(const struct vrml_node *node)
{
	for (size_t i = 0; i < ARRAY_COUNT(sensors); i++)
		if (vrml_is(node, sensors[i].type))
			return &sensors[i];
	return NULL;
}

bool vrml_is_drag_sensor(const struct vrml_node *node)
{
	return sensor_of(node) != NULL;
}

static void read_plane(struct scenery_drag *out, const struct vrml_node *node)
{
	vrml_get_floats(out->offset, node, "offset", 3, (const float[3]){ 0, 0, 0 });
	vrml_get_floats(out->low, node, "minPosition", 2, (const float[2]){ 0, 0 });
	vrml_get_floats(out->high, node, "maxPosition", 2, (const float[2]){ -1, -1 });
}

static void read_cylinder(struct scenery_drag *out, const struct vrml_node *node)
{
	const float right = 1.5707f;

	out->offset[0] = vrml_get_float(node, "offset", 0);
	out->low[0] = vrml_get_float(node, "minAngle", 0);
	out->high[0] = vrml_get_float(node, "maxAngle", -1);
	out->disc_rad = fminf(fmaxf(vrml_get_float(node, "diskAngle", 0.262f), 0), right);
}

static void read_sphere(struct scenery_drag *out, const struct vrml_node *node)
{
	float rotation[4];

	vrml_get_floats(rotation, node, "offset", 4, (const float[4]){ 0, 1, 0, 0 });
	turn_about(out->offset, rotation, rotation[3]);
}

static bool is_near(const float *numbers, int count)
{
	for (int i = 0; i < count; i++)
		if (!(fabsf(numbers[i]) <= far))
			return false;
	return true;
}

static int read_sensor(struct scenery_drag *out, const struct vrml_node *node,
		       enum scenery_drag_kind kind, struct diagnostics *diagnostics)
{
	*out = (struct scenery_drag){ .kind = kind,
				      .keeps = vrml_get_integer(node, "autoOffset", 1) != 0 };
	if (kind == SCENERY_DRAG_PLANE)
		read_plane(out, node);
	else if (kind == SCENERY_DRAG_CYLINDER)
		read_cylinder(out, node);
	else
		read_sphere(out, node);
	if (is_near(out->offset, 4) && is_near(out->low, 2) && is_near(out->high, 2))
		return 0;
	return diagnostics_add(diagnostics, -EBADMSG, node->file, node->line,
			       "the limits or the offset of this %s are over 1000000; correct them",
			       node->type->name);
}

static int add_instances(struct scenery_maker *maker, struct scenery_drag *drag,
			 const struct vrml_instances *instances, const struct vrml_node *sensor,
			 const struct vrml_node *target)
{
	int rc = 0;

	for (uint32_t s = 0; s < instances->count; s++) {
		if (instances->items[s].of != sensor)
			continue;
		drag->handle = instances->items[s].node;
		for (uint32_t t = 0; t < instances->count && rc == 0; t++) {
			drag->node = instances->items[t].node;
			if (instances->items[t].of == target)
				rc = scenery_add_drag(maker, drag);
		}
	}
	return rc;
}

int vrml_drags_add(struct scenery_maker *maker, const struct vrml_route *route,
		   const struct vrml_instances *instances, struct diagnostics *diagnostics,
		   struct diagnostics *warnings)
{
	const struct vrml_node *from = *route->from, *to = *route->to;
	const struct sensor *sensor = from ? sensor_of(from) : NULL;
	struct scenery_drag drag;
	int rc;

	if (!sensor || !to || strcmp(route->out, sensor->out) != 0 || !vrml_is(to, "Transform") ||
	    !vrml_event_sets(route->in, sensor->field))
		return 0;
	if (!vrml_get_integer(from, "enabled", 1)) {
		diagnostics_add(warnings, 0, from->file, from->line,
				"this %s is not enabled; it was left out", from->type->name);
		return 1;
	}
	rc = read_sensor(&drag, from, sensor->kind, diagnostics);
	if (rc == 0)
		rc = add_instances(maker, &drag, instances, from, to);
	return rc < 0 ? rc : 1;
}
