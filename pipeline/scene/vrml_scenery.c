/* Walks the graph of a scene. A Transform with something moving below it, or something that depends
 * on the eye's place, becomes a node of the scenery; the places of all others are put into the
 * triangles, which costs a terminal nothing. */
#include "pipeline/scene/vrml_scenery.h"

#include <errno.h>
#include <string.h>

#include "base/map.h"
#include "geometry/turn.h"
#include "geometry/vec.h"
#include "pipeline/scene/scenery_image.h"
#include "pipeline/scene/scenery_look.h"
#include "pipeline/scene/vrml_bends.h"
#include "pipeline/scene/vrml_drags.h"
#include "pipeline/scene/vrml_faces.h"
#include "pipeline/scene/vrml_graph.h"
#include "pipeline/scene/vrml_motions.h"
#include "pipeline/scene/vrml_shapes.h"

/* Whether a node, or something below it, moves, is touched, or depends on the eye's place. */
enum moving { STILL, MOVING, TARGET /* moves, and what is above it is not judged yet */ };

struct walk {
	struct scenery_maker *maker;
	const struct vrml *scene;
	struct vrml_instances instances;
	struct map moving; /* node -> enum moving; none: not judged yet */
	struct diagnostics *diagnostics, *warnings;
	uint32_t root; /* node of the scenery that stands for the file */
	uint32_t visits, depth;
	const struct vrml_options *options;
	struct picture picture; /* of the texture that was used last, if it could be read */
	const struct vrml_node *picture_of;
};

static map_key key_of(const struct vrml_node *node)
{
	return (map_key)(uintptr_t)node;
}

static int fail(const struct walk *walk, int rc, const struct vrml_node *node)
{
	return diagnostics_add(walk->diagnostics, rc, node->file, node->line, "%s",
			       rc == -EFBIG ? "more than scenery may have; simplify the scene, or "
					      "use it as a scan"
					    : "too large for this machine's memory");
}

/* ---- what moves */

static int mark_targets(struct walk *walk)
{
	int rc = 0;

	for (const struct vrml_route *route = walk->scene->routes; route && rc == 0;
	     route = route->before)
		if (*route->to &&
		    (vrml_is(*route->to, "Transform") || vrml_is(*route->to, "Material")))
			rc = map_set(&walk->moving, key_of(*route->to), TARGET);
	return rc;
}

static bool is_sensor(const struct vrml_node *node)
{
	return vrml_is(node, "TouchSensor") || vrml_is_drag_sensor(node);
}

static bool has_sensor(const struct vrml_node *node)
{
	uint32_t count;
	struct vrml_node *const *children = vrml_children(node, &count);

	for (uint32_t i = 0; i < count; i++)
		if (is_sensor(children[i]))
			return true;
	return false;
}

static bool is_moving(const struct walk *walk, const struct vrml_node *node)
{
	uint64_t found = map_get(&walk->moving, key_of(node));

	return found == MOVING || found == TARGET;
}

/* Returns the interpolator that bends a Shape; NULL: none. */
static const struct vrml_node *bender_of(const struct walk *walk, const struct vrml_node *shape)
{
	const struct vrml_node *geometry = vrml_get_node(shape, "geometry");

	return geometry ? vrml_bender_of(walk->scene, geometry) : NULL;
}

/* Whether a route sets a field of a node. */
static bool is_set(const struct walk *walk, const struct vrml_node *node, const char *field)
{
	for (const struct vrml_route *route = walk->scene->routes; route; route = route->before)
		if (*route->to == node && vrml_event_sets(route->in, field))
			return true;
	return false;
}

/* Returns the children of a node: of an LOD that says no distances, the first level. */
static struct vrml_node *const *children_of(const struct vrml_node *node, uint32_t *count)
{
	const struct vrml_value *range = vrml_is(node, "LOD") ? vrml_get(node, "range") : NULL;

	return range && range->count > 0 ? vrml_levels(node, count) : vrml_children(node, count);
}

/* Whether the eye's place chooses among the children. */
static bool has_levels(const struct vrml_node *node)
{
	uint32_t count;

	(void)children_of(node, &count);
	return vrml_is(node, "LOD") && count > 1;
}

/* Marks the nodes above what moves. Each is judged once. */
static int mark(struct walk *walk, const struct vrml_node *node)
{
	const struct vrml_node *material;
	struct vrml_node *const *children;
	uint32_t count;
	uint64_t was = map_get(&walk->moving, key_of(node));
	bool moves =
		was == TARGET || has_sensor(node) || vrml_is(node, "Billboard") || has_levels(node);
	int rc = 0;

	if (was != MAP_NONE && was != TARGET)
		return 0;
	if (walk->depth == VRML_DEPTH_MAX)
		return diagnostics_add(walk->diagnostics, -EFBIG, node->file, node->line,
				       "USE nests nodes over %d deep; flatten the scene",
				       VRML_DEPTH_MAX);
	walk->depth++;
	material = vrml_is(node, "Shape")
			   ? vrml_node_of(vrml_node_of(node, "appearance", "Appearance"),
					  "material", "Material")
			   : NULL;
	moves = moves || (material && is_moving(walk, material)) ||
		(vrml_is(node, "Shape") && bender_of(walk, node));
	children = children_of(node, &count);
	for (uint32_t i = 0; i < count && rc == 0; i++) {
		rc = mark(walk, children[i]);
		moves = moves || is_moving(walk, children[i]);
	}
	walk->depth--;
	if (rc == 0 && map_set(&walk->moving, key_of(node), moves ? MOVING : STILL) < 0)
		rc = fail(walk, -ENOMEM, node);
	return rc;
}

/* ---- nodes */

static void get_turn(float out[4], const struct vrml_node *node, const char *field)
{
	float rotation[4];

	vrml_get_floats(rotation, node, field, 4, (const float[4]){ 0, 0, 1, 0 });
	turn_about(out, rotation, rotation[3]);
}

static void get_place(struct scenery_place *out, const struct vrml_node *node)
{
	static const float zero[3], one[3] = { 1, 1, 1 };

	vrml_get_floats(out->move_m, node, "translation", 3, zero);
	vrml_get_floats(out->centre_m, node, "center", 3, zero);
	vrml_get_floats(out->scale, node, "scale", 3, one);
	get_turn(out->turn, node, "rotation");
	get_turn(out->stretch, node, "scaleOrientation");
}

static void get_facing(struct scenery_sight *out, const struct vrml_node *billboard)
{
	out->kind = SCENERY_SIGHT_FACES;
	vrml_get_floats(out->at, billboard, "axisOfRotation", 3, (const float[3]){ 0, 1, 0 });
	vec_normalise(out->at);
}

static int note(struct walk *walk, const struct vrml_node *of, uint32_t node)
{
	return vrml_instances_add(&walk->instances,
				  &(struct vrml_instance){ .of = of, .node = node });
}

/* Adds a node for one of the scene, and notes that it stands for it. */
static int add_node(struct walk *walk, const struct vrml_node *of, uint32_t parent,
		    uint32_t *number)
{
	struct scenery_node node = { .parent = parent,
				     .layer = SCENERY_NONE,
				     .place = scenery_at_rest };
	int rc;

	if (vrml_is(of, "Transform"))
		get_place(&node.place, of);
	if (vrml_is(of, "Billboard"))
		get_facing(&node.sight, of);
	rc = scenery_add_node(walk->maker, &node, number);
	if (rc == 0)
		rc = note(walk, of, *number);
	return rc;
}

/* ---- shapes */

static float crease_of(const struct vrml_node *geometry)
{
	const float round = 0.5f, given = 1;
	float crease = 0;

	if (vrml_is(geometry, "Sphere") || vrml_is(geometry, "Cone") ||
	    vrml_is(geometry, "Cylinder"))
		return round;
	if (vrml_field_named(geometry->type, "creaseAngle", 11) >= 0)
		crease = vrml_get_float(geometry, "creaseAngle", 0);
	/* The exporter had normals, so it had round surfaces. */
	if (crease <= 0 && vrml_field_named(geometry->type, "normal", 6) >= 0 &&
	    vrml_get_node(geometry, "normal"))
		return given;
	return crease > 0 ? crease : 0;
}

/* Points and lines have the colour in which they shine, whatever the light (6.24, 6.36); without a
 * Material they are white. */
static void get_line_material(struct scenery_material *out, uint8_t rgb[3],
			      const struct vrml_node *material)
{
	static const float black[3], white[3] = { 1, 1, 1 };
	float emissive[3];

	*out = scenery_plain;
	memcpy(emissive, white, sizeof(emissive));
	if (material)
		vrml_get_floats(emissive, material, "emissiveColor", 3, black);
	vrml_colour(rgb, emissive);
}

/* Sets what a Material and the sides of a geometry say, and the colour of its surface. A highlight
 * is lost between the corners of coarse shapes, so it is computed at each pixel. */
static void get_material(struct scenery_material *out, uint8_t rgb[3],
			 const struct vrml_node *material, const struct vrml_node *geometry)
{
	static const float grey[3] = { 0.8f, 0.8f, 0.8f }, black[3];
	float diffuse[3], emissive[3], specular[3];

	*out = scenery_plain;
	if (vrml_is(geometry, "PointSet") || vrml_is(geometry, "IndexedLineSet")) {
		get_line_material(out, rgb, material);
		return;
	}
	out->has_two_sides =
		vrml_is(geometry, "Text") || (vrml_field_named(geometry->type, "solid", 5) >= 0 &&
					      !vrml_get_integer(geometry, "solid", 1));
	vrml_colour(rgb, grey);
	if (!material)
		return;
	vrml_get_floats(diffuse, material, "diffuseColor", 3, grey);
	vrml_get_floats(emissive, material, "emissiveColor", 3, black);
	vrml_get_floats(specular, material, "specularColor", 3, black);
	vrml_colour(rgb, diffuse);
	vrml_colour(out->emissive, emissive);
	vrml_colour(out->specular, specular);
	out->by_pixel = out->specular[0] || out->specular[1] || out->specular[2];
	if (out->by_pixel)
		out->shininess = vec_least(
			vec_most(128 * vrml_get_float(material, "shininess", 0.2f), 1), 128);
	out->opacity = vec_least(1 - vrml_get_float(material, "transparency", 0), 1);
}

/* Adds what the content says of a material, by its name or that of its Appearance. */
static void add_look(const struct walk *walk, struct scenery_material *out, uint8_t rgb[3],
		     const struct vrml_node *appearance, const struct vrml_node *material)
{
	if (!scenery_look_add(walk->maker, material ? material->name : NULL, out) &&
	    !scenery_look_add(walk->maker, appearance ? appearance->name : NULL, out))
		return;
	if (out->substance && !(material && vrml_get(material, "diffuseColor")))
		scenery_look_mean(rgb, out);
}

/* What nobody can see is left out. */
static bool is_visible(const struct scenery_material *material)
{
	return material->opacity >= 1.0f / 255;
}

/* ---- pictures */

/* Reads the picture of an Appearance: the first that ImageTexture's url names. Returns whether
 * there is one, or a negative errno, with a diagnostic but for -ENOMEM. */
static int get_picture(struct walk *walk, const struct vrml_node *look)
{
	const struct vrml_node *texture = look ? vrml_get_node(look, "texture") : NULL;
	char opened[VRML_NAME_BYTES];
	const struct vrml_value *urls;
	int fd;

	if (!texture)
		return 0;
	if (walk->picture_of == texture)
		return walk->picture.rgba != NULL;
	picture_finish(&walk->picture);
	walk->picture_of = texture;
	if (!vrml_is(texture, "ImageTexture")) {
		diagnostics_add(walk->warnings, 0, texture->file, texture->line,
				"%s is left out: scenery shows pictures of ImageTexture",
				texture->type->name);
		return 0;
	}
	urls = vrml_get(texture, "url");
	if (!urls || urls->count == 0)
		return 0;
	fd = vrml_open(walk->scene, texture, urls->strings[0], walk->options, opened);
	return scenery_image_read(&walk->picture, fd, urls->strings[0], texture->file,
				  texture->line, walk->warnings);
}

static bool is_grey(const struct picture *picture)
{
	const size_t count = (size_t)picture->width * picture->height;

	for (size_t i = 0; i < count; i++)
		if (picture->rgba[4 * i] != picture->rgba[4 * i + 1] ||
		    picture->rgba[4 * i] != picture->rgba[4 * i + 2])
			return false;
	return true;
}

/* A picture takes the place of all other colours, unless it is grey (6.22). */
static void prepare(const struct picture *picture, struct soup *soup, const struct vrml_node *look)
{
	const struct vrml_node *uvs = vrml_node_of(look, "textureTransform", "TextureTransform");
	const bool is_coloured = !is_grey(picture);

	for (uint32_t i = 0; i < soup->count; i++)
		for (int k = 0; k < 3; k++) {
			struct soup_corner *corner = &soup->triangles[i].corners[k];

			if (is_coloured)
				memset(corner->rgb, 255, sizeof(corner->rgb));
			if (uvs)
				vrml_transform_uv(corner->uv, uvs);
		}
}

static int add_surface(struct walk *walk, const struct vrml_node *shape, uint32_t node,
		       const float place[16], bool is_mirrored)
{
	const struct vrml_node *look = vrml_node_of(shape, "appearance", "Appearance");
	const struct vrml_node *material = vrml_node_of(look, "material", "Material");
	const struct vrml_node *geometry = vrml_get_node(shape, "geometry"), *bender;
	struct soup soup = { .texture = SOUP_NO_TEXTURE };
	struct scenery_paint paint = { 0 };
	struct scenery_material kept;
	uint8_t rgb[3];
	int rc, has_picture;

	if (!geometry)
		return 0;
	get_material(&kept, rgb, material, geometry);
	add_look(walk, &kept, rgb, look, material);
	if (material && is_set(walk, material, "transparency"))
		kept.opacity = 1; /* its node's */
	if (!is_visible(&kept))
		return 0;
	bender = bender_of(walk, shape);
	soup.keeps_sources = bender != NULL;
	has_picture = get_picture(walk, look);
	if (has_picture < 0)
		return has_picture == -ENOMEM ? fail(walk, has_picture, shape) : has_picture;
	memcpy(soup.place, place, sizeof(soup.place));
	rc = vrml_shape_add(&soup, geometry, rgb, is_mirrored, walk->diagnostics);
	if (rc == 0)
		diagnostics_add(walk->warnings, 0, geometry->file, geometry->line,
				"%s is no geometry; it was left out", geometry->type->name);
	if (rc > 0) {
		scenery_look_grain(&kept, &soup, &walk->maker->out.nodes[walk->root].place);
		if (has_picture) {
			prepare(&walk->picture, &soup, look);
			paint.picture = &walk->picture;
		}
		if (bender)
			rc = vrml_bent_add(walk->maker, node, &kept, &soup, crease_of(geometry),
					   &paint, geometry, bender, walk->diagnostics);
		else
			rc = scenery_add_surface(walk->maker, node, &kept, soup.triangles,
						 soup.count, crease_of(geometry), &paint);
		if (rc == -EFBIG || rc == -ENOMEM)
			rc = fail(walk, rc, geometry);
	}
	soup_finish(&soup);
	return rc;
}

/* Adds a node for a shape whose Material or points change, below *node, which is set to it. */
static int add_shape_node(struct walk *walk, const struct vrml_node *shape,
			  const struct vrml_node *material, uint32_t *node)
{
	const struct vrml_node *geometry = vrml_get_node(shape, "geometry");
	const struct vrml_node *look = vrml_node_of(shape, "appearance", "Appearance");
	const struct vrml_node *bender = bender_of(walk, shape);
	struct vrml_instance of_material = { .of = material };
	const struct scenery_node own = { .parent = *node,
					  .layer = SCENERY_NONE,
					  .place = scenery_at_rest };
	int rc = scenery_add_node(walk->maker, &own, node);

	of_material.node = *node;
	of_material.is_lines =
		geometry && (vrml_is(geometry, "PointSet") || vrml_is(geometry, "IndexedLineSet"));
	of_material.has_own_colours =
		(look && vrml_get_node(look, "texture")) ||
		(geometry && vrml_field_named(geometry->type, "color", 5) >= 0 &&
		 vrml_get_node(geometry, "color"));
	if (rc == 0 && material)
		rc = vrml_instances_add(&walk->instances, &of_material);
	if (rc == 0 && bender)
		rc = vrml_instances_add(
			&walk->instances,
			&(struct vrml_instance){ .of = vrml_get_node(geometry, "coord"),
						 .node = *node,
						 .bender = bender });
	return rc;
}

static int add_shape(struct walk *walk, const struct vrml_node *shape, uint32_t node,
		     const float place[16], bool is_mirrored)
{
	const struct vrml_node *material = vrml_node_of(
		vrml_node_of(shape, "appearance", "Appearance"), "material", "Material");

	if ((material && is_moving(walk, material)) || bender_of(walk, shape)) {
		int rc = add_shape_node(walk, shape, material, &node);

		if (rc < 0)
			return fail(walk, rc, shape);
	}
	return add_surface(walk, shape, node, place, is_mirrored);
}

/* ---- fog */

/* Keeps the first fog of all files, as a browser shows the first one that it finds. */
static void add_fog(const struct walk *walk, const struct vrml_node *node)
{
	struct scenery_fog *fog = &walk->maker->out.fog;
	const struct scenery_node *root = &walk->maker->out.nodes[walk->root];
	const struct vrml_value *type = vrml_get(node, "fogType");
	const float range = vrml_get_float(node, "visibilityRange", 0) * root->place.scale[0];
	float colour[3];

	if (!(range > 0))
		return;
	if (fog->range_m > 0) {
		diagnostics_add(walk->warnings, 0, node->file, node->line,
				"there is a Fog already; this one was left out");
		return;
	}
	vrml_get_floats(colour, node, "color", 3, (const float[3]){ 1, 1, 1 });
	vrml_colour(fog->rgb, colour);
	fog->range_m = range;
	fog->layer = root->layer;
	fog->is_exponential =
		type && type->count > 0 && strcmp(type->strings[0], "EXPONENTIAL") == 0;
}

/* Scan and scenery have one light and one background. */
static void say_left_out(const struct walk *walk, const struct vrml_node *node)
{
	const char *instead = NULL;

	if (vrml_is(node, "DirectionalLight") || vrml_is(node, "PointLight") ||
	    vrml_is(node, "SpotLight"))
		instead = "sun";
	if (vrml_is(node, "Background"))
		instead = "background";
	if (instead)
		diagnostics_add(walk->warnings, 0, node->file, node->line,
				"%s is left out; scan and scenery have the %s of temple.ini",
				node->type->name, instead);
}

/* ---- groups */

/* Notes which node a sensor beside these children answers for. */
static int note_sensors(struct walk *walk, struct vrml_node *const *children, uint32_t count,
			uint32_t node)
{
	int rc = 0;

	for (uint32_t i = 0; i < count && rc == 0; i++)
		if (is_sensor(children[i]))
			rc = note(walk, children[i], node);
	return rc;
}

/* Adds a node for a level of an LOD, below *node, which is set to it. As 6.26 has it, the last
 * level goes on, and those without a distance are not seen: *is_seen is then false. */
static int add_level(struct walk *walk, const struct vrml_node *lod, uint32_t level, uint32_t count,
		     uint32_t *node, bool *is_seen)
{
	const struct vrml_value *range = vrml_get(lod, "range");
	struct scenery_node own = { .parent = *node,
				    .layer = SCENERY_NONE,
				    .place = scenery_at_rest,
				    .sight = { .kind = SCENERY_SIGHT_LEVEL, .to = INFINITY } };
	int rc;

	*is_seen = level <= range->count;
	if (!*is_seen)
		return 0;
	vrml_get_floats(own.sight.at, lod, "center", 3, (const float[3]){ 0 });
	if (level > 0)
		own.sight.from = range->floats[level - 1];
	if (level + 1 < count && level < range->count)
		own.sight.to = range->floats[level];
	if (!(own.sight.to > own.sight.from))
		return diagnostics_add(walk->diagnostics, -EBADMSG, lod->file, lod->line,
				       "LOD has distances in range that do not ascend from above "
				       "0; correct them");
	rc = scenery_add_node(walk->maker, &own, node);
	return rc < 0 ? fail(walk, rc, lod) : 0;
}

static int visit(struct walk *walk, const struct vrml_node *of, uint32_t node,
		 const float parent[16], bool is_mirrored);

static int visit_levels(struct walk *walk, const struct vrml_node *lod, uint32_t node,
			const float place[16], bool is_mirrored)
{
	uint32_t count;
	struct vrml_node *const *levels = vrml_levels(lod, &count);
	int rc = 0;

	for (uint32_t i = 0; i < count && rc == 0; i++) {
		uint32_t own = node;
		bool is_seen;

		rc = add_level(walk, lod, i, count, &own, &is_seen);
		if (rc == 0 && is_seen)
			rc = visit(walk, levels[i], own, place, is_mirrored);
	}
	return rc;
}

static int visit(struct walk *walk, const struct vrml_node *of, uint32_t node,
		 const float parent[16], bool is_mirrored)
{
	struct vrml_node *const *children;
	float place[16];
	uint32_t count;
	int rc = 0;

	if (++walk->visits > VRML_VISITS_MAX)
		return diagnostics_add(walk->diagnostics, -EFBIG, of->file, of->line,
				       "USE repeats nodes over %d times; split the scene",
				       VRML_VISITS_MAX);
	if (vrml_is(of, "Shape"))
		return add_shape(walk, of, node, parent, is_mirrored);
	if (vrml_is(of, "Fog"))
		add_fog(walk, of);
	say_left_out(walk, of);
	memcpy(place, parent, sizeof(place));
	if (vrml_is(of, "Transform")) {
		float own[16];

		vrml_transform(own, vrml_identity, of);
		is_mirrored ^= vrml_mirrors(own);
		if (!is_moving(walk, of))
			vrml_transform(place, parent, of);
	}
	if (has_levels(of))
		return visit_levels(walk, of, node, place, is_mirrored);
	if (is_moving(walk, of) &&
	    (vrml_is(of, "Transform") || vrml_is(of, "Billboard") || has_sensor(of)))
		rc = add_node(walk, of, node, &node);
	children = vrml_children(of, &count);
	if (rc == 0)
		rc = note_sensors(walk, children, count, node);
	if (rc < 0)
		return fail(walk, rc, of);
	for (uint32_t i = 0; i < count && rc == 0; i++)
		rc = visit(walk, children[i], node, place, is_mirrored);
	return rc;
}

static int add_all(struct walk *walk, uint32_t node)
{
	const struct vrml *scene = walk->scene;
	int rc = mark_targets(walk);

	for (uint32_t i = 0; i < scene->root_count && rc == 0; i++)
		rc = mark(walk, scene->roots[i]);
	if (rc == 0)
		rc = note_sensors(walk, scene->roots, scene->root_count, node);
	for (uint32_t i = 0; i < scene->root_count && rc == 0; i++)
		rc = visit(walk, scene->roots[i], node, vrml_identity, false);
	if (rc == 0)
		rc = vrml_motions_add(walk->maker, scene, &walk->instances, walk->diagnostics,
				      walk->warnings);
	return rc;
}

int vrml_scenery_add(struct scenery_maker *maker, const struct vrml *scene, uint32_t node,
		     const struct vrml_options *options, struct diagnostics *diagnostics,
		     struct diagnostics *warnings)
{
	struct walk walk = { .scene = scene,
			     .options = options,
			     .maker = maker,
			     .root = node,
			     .diagnostics = diagnostics,
			     .warnings = warnings };
	const uint32_t errors = diagnostics ? diagnostics->error_count : 0;
	int rc = add_all(&walk, node);

	if (rc < 0 && scene->root_count > 0 && diagnostics && diagnostics->error_count == errors)
		fail(&walk, rc, scene->roots[0]);
	picture_finish(&walk.picture);
	vrml_instances_finish(&walk.instances);
	map_finish(&walk.moving);
	return rc;
}
