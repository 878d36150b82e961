/* What stands beside the scan in pictures: it hides and is hidden, answers a touch, and dissolves
 * with its layer. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "format/picture.h"
#include "format/scenery_code.h"
#include "geometry/appearance.h"
#include "geometry/substance.h"
#include "geometry/vec.h"
#include "geometry/view.h"
#include "render/display/gl.h"
#include "render/display/headless.h"
#include "render/scene/scene_around.h"
#include "render/scene/scene_parts.h"
#include "tests/format/little_scenery.h"
#include "tests/render/scene/little_stream.h"

enum { WIDTH = 320, HEIGHT = 180, PIXELS = WIDTH * HEIGHT, FRAMES_MAX = 3000 };

static struct little_release *release; /* made once for all tests */

struct stage {
	struct headless *headless;
	struct gl_target target;
	struct scene *scene;
	struct scene_frame frame;
	uint8_t seen[4 * PIXELS];
};

static struct stage stage;
static struct camera eye;

static const struct camera first_eye = {
	.eye_m = { 10, -12, 5 },
	.target_m = { 0, 0, 1.5f },
	.up = { 0, 0, 1 },
	.fov_deg = 45,
	.near_m = 0.1f,
	.far_m = 200,
	.width_px = WIDTH,
	.height_px = HEIGHT,
};

/* Places: the door is 3 m wide, in front of the pillars; the second layer has a wall of 5 m between
 * those in front. The door takes a fifth of a second and stays solid. */
static void add_scenery(struct little_release *r)
{
	struct page_child children[ROOT_CHILDREN_MAX], child;
	struct little_scenery s;
	struct root_page root;
	struct buffer bytes;
	struct page page;

	little_scenery_init(&s);
	memcpy(s.nodes[0].place.move_m, (float[3]){ 0, -6, 0 }, 12);
	memcpy(s.nodes[0].place.scale, (float[3]){ 3, 3, 3 }, 12);
	memcpy(s.nodes[2].place.move_m, (float[3]){ -3, -4, 0 }, 12);
	memcpy(s.nodes[2].place.scale, (float[3]){ 5, 5, 5 }, 12);
	s.motion.duration_s = 0.2f;
	s.numbers[13] = 1;
	buffer_init(&bytes, 1 << 20);
	CHECK(scenery_encode(&bytes, &s.scenery) == 0);
	CHECK(page_decode(&page, little_object_bytes(r, r->root)) == 0);
	CHECK(root_page_decode(&root, page.payload) == 0);
	memcpy(children, page.children, page.child_count * sizeof(*children));
	children[page.child_count] = little_add(r, &bytes, false);
	root.has_scenery = 1;
	buffer_clear(&bytes);
	root_page_encode(&bytes, &root);
	child = little_page(r, PAGE_ROOT, children, page.child_count + 1, &bytes);
	r->root = child.hash;
	r->root_bytes = child.size;
	page_finish(&page);
	buffer_finish(&bytes);
}

static int raise_stage(void **state)
{
	static const struct scene_options usual = {
		.mode = SCENE_LUMIGRAPH,
		.texture_budget_bytes = 96 << 20,
		.geometry_budget_bytes = 64 << 20,
		.triangle_budget = 200000,
		.patch_error_px = 1,
		.upload_budget_us = 20000,
		.worker_count = 2,
	};

	(void)state;
	memset(&stage, 0, sizeof(stage));
	eye = first_eye;
	CHECK(headless_create(&stage.headless) == 0);
	CHECK(gl_target_create(&stage.target, WIDTH, HEIGHT) == 0);
	CHECK(scene_create(&stage.scene, &usual) == 0);
	return scene_open(stage.scene, release->root, release->root_bytes);
}

static int strike_stage(void **state)
{
	(void)state;
	scene_destroy(stage.scene);
	gl_target_destroy(&stage.target);
	CHECK(gl_check("the test") == 0);
	headless_destroy(stage.headless);
	return 0;
}

static void draw(void)
{
	gl_target_bind(&stage.target);
	CHECK(scene_dispatch(stage.scene) == 0);
	scene_draw(stage.scene, &eye, NULL, &stage.frame);
}

static void settle(const char *name)
{
	char path[512];
	struct buffer file;

	stage.frame.settled = false;
	for (int frames = 0; !stage.frame.settled; frames++) {
		CHECK(frames < FRAMES_MAX);
		draw();
		little_release_serve(release, stage.scene, 16);
	}
	CHECK(gl_target_read(&stage.target, stage.seen) == 0);
	if (!getenv("KEEP_PICTURES"))
		return;
	buffer_init(&file, 64 << 20);
	CHECK(picture_encode_png(&file, &(struct picture){ WIDTH, HEIGHT, stage.seen }) == 0);
	snprintf(path, sizeof(path), "%s/scenery-%s.png", getenv("KEEP_PICTURES"), name);
	CHECK(bytes_write_file(buffer_bytes(&file), path) == 0);
	buffer_finish(&file);
}

/* The pixel of a place. */
static void project(float x, float y, float z, float at[2])
{
	struct view view;
	float from[3], clip[4];

	view_from_camera(&view, &eye);
	vec_sub(from, (float[3]){ x, y, z }, view.eye_m);
	for (int row = 0; row < 4; row++)
		clip[row] = view.clip[row] * from[0] + view.clip[4 + row] * from[1] +
			    view.clip[8 + row] * from[2] + view.clip[12 + row];
	at[0] = (clip[0] / clip[3] + 1) / 2 * WIDTH;
	at[1] = (1 - clip[1] / clip[3]) / 2 * HEIGHT;
}

/* Whether the picture shows the wood of the scenery at a place, lit or not. */
static bool is_wood(float x, float y, float z)
{
	const uint8_t *pixel;
	float at[2];

	project(x, y, z, at);
	pixel = &stage.seen[4 * ((int)at[1] * WIDTH + (int)at[0])];
	return abs(2 * pixel[0] - 3 * pixel[1]) < 12 && abs(pixel[1] - 2 * pixel[2]) < 12;
}

/* How many pixels are seen to differ from another picture. Which images colour a settled view may
 * depend on the way to it. */
static int differing(const uint8_t *other)
{
	int count = 0;

	for (int i = 0; i < 4 * PIXELS; i += 4)
		count += abs(stage.seen[i] - other[i]) > 16 ||
			 abs(stage.seen[i + 1] - other[i + 1]) > 16;
	return count;
}

static bool touch(float x, float y, float z)
{
	float at[2];

	project(x, y, z, at);
	return scene_touch(stage.scene, &eye, at[0], at[1]);
}

static void a_door_answers_a_finger_and_closes_again(void **state)
{
	static uint8_t closed[4 * PIXELS];
	float at[2], point[3];

	(void)state;
	settle("closed");
	memcpy(closed, stage.seen, sizeof(closed));
	CHECK(is_wood(1.5f, -6, 1.5f) && is_wood(2.8f, -6, 0.3f) && !is_wood(3.3f, -6, 1.5f));
	project(1.5f, -6, 1.5f, at);
	CHECK(scene_pick(stage.scene, &eye, at[0], at[1], point));
	CHECK(fabsf(point[1] + 6) < 0.02f && fabsf(point[0] - 1.5f) < 0.02f);
	CHECK(!touch(4, -5, 2));  /* a pillar */
	CHECK(!touch(0, 30, 30)); /* the sky */
	CHECK(touch(1.5f, -6, 1.5f));
	settle("open");
	CHECK(differing(closed) > PIXELS / 100);
	CHECK(!is_wood(2.8f, -6, 0.3f) && is_wood(0, -4.5f, 1.5f));
	CHECK(!touch(2.8f, -6, 0.3f)); /* it is not there any more */
	CHECK(touch(0, -4.5f, 1.5f));
	settle("closed-again");
	CHECK(differing(closed) < PIXELS / 400);
}

static void a_pillar_in_front_hides_the_second_layer(void **state)
{
	static uint8_t found[4 * PIXELS];

	(void)state;
	settle("found");
	memcpy(found, stage.seen, sizeof(found));
	CHECK(!is_wood(0, -4, 4) && scene_layer(stage.scene) == 0);
	CHECK(scene_scenery(stage.scene)->layer_count == 2);
	scene_choose_layer(stage.scene, 7); /* there is none */
	CHECK(scene_layer(stage.scene) == 0);
	scene_choose_layer(stage.scene, 1);
	settle("built");
	CHECK(is_wood(0, -4, 4) && !is_wood(2, -4, 3) /* behind the pillar */);
	scene_reset_scenery(stage.scene);
	settle("found-again");
	CHECK(differing(found) < PIXELS / 400);
}

static void a_section_cuts_it_too(void **state)
{
	struct scene_tools tools = { .section = { .on = false } };

	(void)state;
	section_init(&tools.section, (float[3]){ -8, -8, -0.5f }, (float[3]){ 8, 8, 5 });
	section_face(&tools.section, eye.eye_m, (float[3]){ 0, 1, 0 });
	section_push(&tools.section, 4); /* y = -4: behind the door */
	scene_use(stage.scene, &tools);
	settle("cut");
	CHECK(!is_wood(1.5f, -6, 1.5f) && !touch(1.5f, -6, 1.5f));
	tools.section.on = false;
	tools.rake.on = true;
	rake_place(&tools.rake, -0.6f, 0.5f);
	scene_use(stage.scene, &tools);
	settle("rake");
	CHECK(is_wood(1.5f, -6, 1.5f));
}

/* Makes a picture that came to rest begin again. */
static void draw_again(void)
{
	struct scene_tools tools = { .rake = { .on = true } };

	scene_use(stage.scene, &tools);
	settle("again");
	tools.rake.on = false;
	scene_use(stage.scene, &tools);
}

/* Of the scan, its images and the door alike. */
static void fog_hides_by_distance(void **state)
{
	static uint8_t clear[4 * PIXELS];
	struct scenery_fog *fog;
	int seen = 0;

	(void)state;
	settle("clear");
	memcpy(clear, stage.seen, sizeof(clear));
	fog = &stage.scene->scenery.content.fog;
	*fog = (struct scenery_fog){ .range_m = 40,
				     .rgb = { 250, 40, 250 },
				     .layer = SCENERY_NONE };
	draw_again();
	settle("fog");
	for (int i = 0; i < PIXELS; i += 7) {
		const float x = (float)(i % WIDTH) + 0.5f, y = (float)(i / WIDTH) + 0.5f;
		float point[3], share;

		/* the sky has none */
		share = scene_pick(stage.scene, &eye, x, y, point)
				? appearance_fog(vec_distance(point, eye.eye_m), fog->range_m,
						 false)
				: 0;
		for (int k = 0; k < 3; k++)
			seen += fabsf((float)clear[4 * i + k] * (1 - share) +
				      (float)fog->rgb[k] * share - (float)stage.seen[4 * i + k]) <
				6;
	}
	print_message("%d channels of %d as computed\n", seen, 3 * PIXELS / 7);
	/* outlines are blended, and not picked so */
	CHECK(seen > 3 * PIXELS / 7 * 9 / 10);
	fog->layer = 1; /* which is not shown */
	draw_again();
	settle("no-fog");
	CHECK(differing(clear) < PIXELS / 400);
}

/* Reads the middle of a face of the cube map, and says whether the scan is there. */
static bool shows_scan(int face)
{
	const uint8_t *sky = stage.scene->root.background;
	uint8_t pixel[4];
	GLuint buffer;

	glGenFramebuffers(1, &buffer);
	glBindFramebuffer(GL_FRAMEBUFFER, buffer);
	glFramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0,
			       GL_TEXTURE_CUBE_MAP_POSITIVE_X + (GLenum)face,
			       stage.scene->scenery.picture.around, 0);
	CHECK(glCheckFramebufferStatus(GL_FRAMEBUFFER) == GL_FRAMEBUFFER_COMPLETE);
	glReadPixels(SCENE_AROUND_PX / 2, SCENE_AROUND_PX / 2, 1, 1, GL_RGBA, GL_UNSIGNED_BYTE,
		     pixel);
	glDeleteFramebuffers(1, &buffer);
	return memcmp(pixel, sky, 3) != 0;
}

/* The door, made a mirror, looks to -y, away from the pillars behind it. */
static void a_mirror_shows_scan_and_sky(void **state)
{
	struct scenery *s = &stage.scene->scenery.content;
	float direction[3], point[3], at[2];
	const uint8_t *sky, *pixel;

	(void)state;
	settle("dull");
	CHECK(stage.scene->scenery.picture.around == 0); /* nothing needs it */
	for (uint32_t i = 0; i < s->material_count; i++) {
		s->materials[i].by_pixel = true;
		s->materials[i].mirror = 1;
	}
	draw_again();
	settle("mirror");
	CHECK(!shows_scan(4) && shows_scan(5)); /* sky above, ground below */
	/* A place high on the door shows what is behind the eye, which is sky. */
	sky = stage.scene->root.background;
	project(1.5f, -6, 2.9f, at);
	pixel = &stage.seen[4 * ((int)at[1] * WIDTH + (int)at[0])];
	for (int k = 0; k < 3; k++)
		CHECK(abs(pixel[k] - sky[k]) < 8);
	/* Seen from above, its foot shows ground: the ray goes down, before the door. */
	vec_sub(direction, (float[3]){ 0.2f, -6, 0.1f }, eye.eye_m);
	direction[1] = -direction[1];
	vec_normalise(direction);
	vec_add_scaled(point, (float[3]){ 1.5f, -6, 1.5f }, 1, direction);
	CHECK(point[2] < 1.5f);
	CHECK(!is_wood(0.2f, -6, 0.1f));
}

/* Puts a red picture on the door; another one is nowhere. */
static void add_pictures(struct scenery *s)
{
	s->texture_count = 2;
	free(s->textures);
	s->textures = calloc(2, sizeof(*s->textures));
	s->meshes[0].uvs = calloc(s->meshes[0].vertex_count, sizeof(*s->meshes[0].uvs));
	CHECK(s->textures && s->meshes[0].uvs);
	s->materials[0].texture = 1;
	for (int i = 0; i < 2; i++) {
		struct scenery_texture *texture = &s->textures[i];

		*texture =
			(struct scenery_texture){ .width = 8, .height = 8, .rgba = calloc(64, 4) };
		CHECK(texture->rgba);
		for (int k = 0; k < 64; k++)
			texture->rgba[4 * k] = 255;
	}
}

/* The door is a board that turns about its left edge, as in VRML97: y is up in it, z before it. */
static void make_billboard(void)
{
	const float h = sqrtf(0.5f);
	struct scene_scenery *own = &stage.scene->scenery;
	struct scenery_node *nodes = own->content.nodes;

	nodes[0].place.move_m[1] = -8;
	nodes[0].place.turn[0] = nodes[0].place.turn[3] = h;
	nodes[0].sight = (struct scenery_sight){ SCENERY_SIGHT_FACES, { 0, 1, 0 }, 0, 0 };
	nodes[1].place.turn[0] = -h;
	nodes[1].place.turn[3] = h;
	own->content.materials[0].has_two_sides = false;
	pose_finish(&own->pose);
	CHECK(pose_init(&own->pose, &own->content) == 0);
	draw_again();
}

/* Its middle is 1.5 m right of its edge, wherever the eye is. */
static void a_billboard_is_seen_and_touched_from_all_sides(void **state)
{
	static const float sides[3][2] = { { 12, -14 }, { -12, -14 }, { -12, 2 } };

	(void)state;
	settle("before-billboard");
	make_billboard();
	for (int i = 0; i < 3; i++) {
		float right[3] = { -(sides[i][1] + 8), sides[i][0], 0 }, edge[3] = { 0, -8, 1.5f };
		float at[3], left[3], pixel[2], point[3];
		char name[32];

		eye.eye_m[0] = sides[i][0];
		eye.eye_m[1] = sides[i][1];
		eye.target_m[1] = -7;
		snprintf(name, sizeof(name), "billboard-%d", i);
		settle(name);
		vec_normalise(right);
		vec_add_scaled(at, edge, 2.9f, right);
		vec_add_scaled(left, edge, -0.1f, right);
		CHECK(is_wood(at[0], at[1], at[2]) && !is_wood(left[0], left[1], left[2]));
		CHECK(!touch(left[0], left[1], left[2]));
		project(at[0], at[1], at[2], pixel);
		CHECK(scene_pick(stage.scene, &eye, pixel[0], pixel[1], point));
		CHECK(vec_distance(point, at) < 0.03f);
		CHECK(i < 2 || /* it begins to move then */ touch(at[0], at[1], at[2]));
	}
}

/* As if it had just come, with a picture on wood that has relief on the door, and a glossy mirror
 * in the second layer. */
static void come_again(void)
{
	struct scene_scenery *own = &stage.scene->scenery;
	struct scenery *s = &own->content;

	s->materials[0].by_pixel = true;
	s->materials[0].substance = SUBSTANCE_WOOD;
	s->materials[0].relief_m = 0.01f;
	s->materials[1] = (struct scenery_material){ .by_pixel = true,
						     .opacity = 1,
						     .specular = { 90, 90, 90 },
						     .shininess = 20,
						     .mirror = 0.5f,
						     .grain = { 0, 0, 1 } };
	s->material_count = 2; /* the decoder leaves room for one more */
	s->meshes[1].material = 1;
	add_pictures(s);
	CHECK(scenery_textures_load(&own->picture.textures, s) == 0);
	scenery_programs_finish(&own->picture.programs);
	pose_finish(&own->pose);
	CHECK(pose_init(&own->pose, s) == 0);
	own->is_ready = false;
}

/* Draws until the picture has settled; no frame may build two programs, upload two pictures, or
 * draw two faces of what mirrors show. Returns how many programs there are then. */
static uint32_t count_programs(void)
{
	const struct scene_scenery *own = &stage.scene->scenery;

	for (int frames = 0; frames < FRAMES_MAX; frames++) {
		const uint32_t programs = own->picture.programs.count;
		const uint32_t textures = own->picture.textures.count;
		const int face = own->around.face;

		gl_target_bind(&stage.target);
		scene_draw(stage.scene, &eye, NULL, &stage.frame);
		little_release_serve(release, stage.scene, 16);
		CHECK(own->picture.programs.count - programs <= 1);
		CHECK(own->picture.textures.count - textures <= 1);
		CHECK(own->around.face == (face + 1) % 6 || own->around.face == face);
		/* what appears, and what mirrors show, is complete */
		CHECK(own->is_ready || own->pose.appeared == 0);
		CHECK(!own->is_ready || own->picture.around);
		if (stage.frame.settled)
			break;
	}
	CHECK(stage.frame.settled && own->is_ready && !own->lacks);
	return own->picture.programs.count;
}

static void a_frame_builds_one_program_at_most(void **state)
{
	struct scene_tools tools = { .rake = { .on = true } };
	struct scene_memory memory;
	const uint8_t *pixel;
	float at[2];

	(void)state;
	settle("plain");
	come_again();
	scene_choose_layer(stage.scene, 1);
	/* of each material the one that dissolves, before it appears, and the one that does not */
	assert_int_equal(count_programs(), 4);
	CHECK(gl_target_read(&stage.target, stage.seen) == 0);
	project(1.5f, -6, 1.5f, at);
	pixel = &stage.seen[4 * ((int)at[1] * WIDTH + (int)at[0])];
	CHECK(pixel[0] > 30 && pixel[1] == 0 && pixel[2] == 0);
	scene_memory(stage.scene, &memory);
	CHECK(memory.geometry_bytes == stage.scene->geometry.bytes + 2 * (uint64_t)64 * 4 * 4 / 3);
	/* under a tool, one that serves both until each has its own */
	rake_place(&tools.rake, -0.6f, 0.5f);
	scene_use(stage.scene, &tools);
	assert_int_equal(count_programs(), 7);
}

/* ---- where frames take too long */

static void draw_with_share(float share)
{
	struct scene_effort effort = scene_effort_full;

	effort.scale = 0.5f;
	effort.share = share;
	scene_spend(stage.scene, &effort);
	draw();
	CHECK(gl_target_read(&stage.target, stage.seen) == 0);
}

/* From an eye that goes on to the side, slowly. */
static void draw_aside(float share)
{
	usleep(10000);
	eye.eye_m[0] += 0.02f;
	draw_with_share(share);
}

/* The same until there is a picture to warp. */
static void reach_first(void)
{
	for (int i = 0; !stage.scene->references.has_shown; i++) {
		CHECK(i < 20);
		draw_aside(0.2f);
	}
}

/* The same as before, in pictures that are warped for the frames in between. */
static void a_door_is_where_the_eye_sees_it_in_a_warped_picture(void **state)
{
	const struct scene_references *r = &stage.scene->references;
	float moved = 0;

	(void)state;
	settle("closed");
	reach_first();
	for (int i = 0; i < 40; i++) {
		draw_aside(0.2f);
		moved = vec_most(moved, vec_distance(r->of[r->shown].view.eye_m, eye.eye_m));
		CHECK(is_wood(1.5f, -6, 1.5f) && is_wood(2.7f, -6, 0.5f) &&
		      !is_wood(3.4f, -6, 1.5f));
		CHECK(is_wood(0.3f, -6, 2.7f) && !is_wood(-0.4f, -6, 1.5f));
	}
	CHECK(moved > 0.03f);
}

/* Until it has opened, whole pictures are drawn, and none from before is shown after it. */
static void a_door_that_opens_before_an_eye_that_rests_is_not_warped(void **state)
{
	const struct scene_references *r = &stage.scene->references;
	int frames = 0;

	(void)state;
	settle("closed");
	reach_first();
	draw_with_share(0.2f);
	CHECK(touch(1.5f, -6, 1.5f));
	do {
		draw_with_share(0.2f);
		CHECK(frames++ < FRAMES_MAX);
		CHECK(!stage.scene->scenery.moves || (!r->has_shown && !r->is_begun));
	} while (stage.scene->scenery.moves);
	CHECK(frames > 2);
	draw_aside(0.2f);
	CHECK(r->has_shown && !is_wood(2.8f, -6, 0.3f) && is_wood(0, -4.5f, 1.5f));
}

/* It is in each picture as it was when that was drawn. */
static void a_door_that_opens_beside_an_eye_that_moves_is_warped(void **state)
{
	const struct scene_references *r = &stage.scene->references;
	int shown;
	int pictures = 0;

	(void)state;
	settle("closed");
	reach_first();
	CHECK(touch(1.5f, -6, 1.5f));
	for (int frames = 0; stage.scene->scenery.moves || frames == 0; frames++) {
		shown = r->shown;
		draw_aside(0.2f);
		CHECK(r->has_shown && frames < FRAMES_MAX);
		pictures += r->shown != shown;
	}
	CHECK(pictures > 0);
	for (shown = r->shown; r->shown == shown || r->is_begun;)
		draw_aside(0.2f);
	CHECK(!is_wood(2.8f, -6, 0.3f) && is_wood(0, -4.5f, 1.5f));
}

/* Returns the depth that a place has in the pass, and sets the pixel where it is. */
static float place_in_pass(const float at_m[3], int *x, int *y)
{
	const struct view *view = &stage.scene->visibility.view;
	float to[3], depth_m;

	vec_sub(to, at_m, view->eye_m);
	depth_m = vec_dot(to, view->forward);
	*x = (int)((1 + vec_dot(to, view->right) / depth_m / view->tan_x) * VISIBILITY_WIDTH / 2);
	*y = (int)((1 + vec_dot(to, view->up) / depth_m / view->tan_y) * VISIBILITY_HEIGHT / 2);
	return depth_m;
}

/* It has depths there, but is no piece, and hides those behind it. */
static void scenery_is_in_the_visibility_pass_of_a_picture(void **state)
{
	static const float on_door_m[3] = { 1.5f, -6, 1.5f }, on_floor_m[3] = { 0, -8, 0 };
	const struct scene_references *r = &stage.scene->references;
	const struct visibility *pass = &stage.scene->visibility;
	struct visibility_point point;
	float depth_m;
	int x, y;

	(void)state;
	settle("closed");
	do
		draw_aside(0.2f);
	while (r->kind != REFERENCE_WITH_PASS || !r->is_counted);
	depth_m = place_in_pass(on_door_m, &x, &y);
	CHECK(!visibility_at(pass, x, y, &point));
	CHECK(fabsf(visibility_depth_m(pass, x, y) - depth_m) < 0.05f);
	depth_m = place_in_pass(on_floor_m, &x, &y);
	CHECK(visibility_at(pass, x, y, &point));
	CHECK(fabsf(point.at_m[2]) < 0.1f &&
	      fabsf(visibility_depth_m(pass, x, y) - depth_m) < 0.2f);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test_setup_teardown(a_door_answers_a_finger_and_closes_again,
						raise_stage, strike_stage),
		cmocka_unit_test_setup_teardown(a_pillar_in_front_hides_the_second_layer,
						raise_stage, strike_stage),
		cmocka_unit_test_setup_teardown(a_billboard_is_seen_and_touched_from_all_sides,
						raise_stage, strike_stage),
		cmocka_unit_test_setup_teardown(a_section_cuts_it_too, raise_stage, strike_stage),
		cmocka_unit_test_setup_teardown(a_mirror_shows_scan_and_sky, raise_stage,
						strike_stage),
		cmocka_unit_test_setup_teardown(fog_hides_by_distance, raise_stage, strike_stage),
		cmocka_unit_test_setup_teardown(a_frame_builds_one_program_at_most, raise_stage,
						strike_stage),
		cmocka_unit_test_setup_teardown(a_door_is_where_the_eye_sees_it_in_a_warped_picture,
						raise_stage, strike_stage),
		cmocka_unit_test_setup_teardown(
			a_door_that_opens_before_an_eye_that_rests_is_not_warped, raise_stage,
			strike_stage),
		cmocka_unit_test_setup_teardown(
			a_door_that_opens_beside_an_eye_that_moves_is_warped, raise_stage,
			strike_stage),
		cmocka_unit_test_setup_teardown(scenery_is_in_the_visibility_pass_of_a_picture,
						raise_stage, strike_stage),
	};
	int failed;

	release = little_release_make(2);
	add_scenery(release);
	failed = cmocka_run_group_tests(tests, NULL, NULL);
	little_release_free(release);
	return failed;
}
