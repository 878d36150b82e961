/* A visit without panel, scene and fetcher: the real modules of app/visit, connected as in the
 * kiosk, over the words of a small release and a clock that the test moves. Included by one source
 * of a program. */
#ifndef GOPURA_TESTS_APP_VISIT_VISIT_FIXTURE_H
#define GOPURA_TESTS_APP_VISIT_VISIT_FIXTURE_H

#include "app/visit/actions.h"
#include "app/visit/visitor.h"
#include "base/clock.h"
#include "storage/info_tools.h"
#include "tests/pipeline/content/info_folder.h"

enum { S = 1000, IDLE_S = 60, CHILDREN_MAX = 16 };

static int64_t now_ms;

int64_t clock_now_ms(void)
{
	return now_ms;
}

int64_t clock_wall_s(void)
{
	return 1795953600;
}

bool clock_wall_is_set(void)
{
	return true;
}

bool clock_wall_is_plausible(void)
{
	return true;
}

static struct {
	struct exhibit shown;
	struct viewport viewport;
	struct redraw redraw;
	struct eye eye;
	struct anchors anchors;
	struct counting counting;
	struct tools tools;
	struct tour_player tours;
	struct back back;
	struct listening listening;
	struct actions actions;
	struct visitor visitor;
	bool is_dark; /* the panel */
	int ended;    /* visits */
} visit;

static inline void on_ended(void *data)
{
	(void)data;
	visit.ended++;
}

static inline struct overlay *words(void)
{
	return exhibit_overlay(&visit.shown);
}

/* A tour of two stops by that name, for a visitor or (attract) for the time while nobody is
 * there. */
static inline void write_tour(const char *id, bool attract)
{
	char text[500];

	snprintf(text, sizeof(text),
		 "{\"tours\": [{\"id\": \"%s\", \"attract\": %s, \"title\": {\"en\": \"Tour\"},\n"
		 "\"stops\": [{\"eye\": [0, -50, 20], \"part\": \"tower\", \"stay\": 3},\n"
		 "{\"eye\": [40, -30, 20], \"target\": [0, 1, 25], \"stay\": 3}]}]}\n",
		 id, attract ? "true" : "false");
	write_text("tours.json", text);
}

/* Shows the words of the content folder in their first language. */
static inline void show_words(void)
{
	static const char *const languages[] = { "en", "km" };
	const struct information_view_options options = {
		.width_px = 1920, .height_px = 1080, .px_per_mm = 4, .sound = true
	};
	struct diagnostics diagnostics = { 0 };
	const struct info_build_options build_options = { .folder = folder,
							  .languages = languages,
							  .language_count = 2,
							  .tools = INFO_TOOL_LIGHT |
								   INFO_TOOL_SECTION,
							  .diagnostics = &diagnostics };
	struct page_child root_children[ROOT_CHILD_COUNT], children[CHILDREN_MAX];
	struct page page = { .kind = PAGE_INFO, .children = children };
	struct page root = { .kind = PAGE_ROOT,
			     .child_count = ROOT_CHILD_COUNT,
			     .children = root_children };
	struct info_built built;
	struct buffer file;

	CHECK(info_build(&built, &build_options) == 0);
	CHECK(built.file_count < CHILDREN_MAX);
	page.child_count = 1 + built.file_count;
	children[0] = (struct page_child){ .hash = hash_of(buffer_bytes(&built.database)),
					   .size = (uint32_t)built.database.size };
	for (uint32_t i = 0; i < built.file_count; i++)
		children[1 + i] = (struct page_child){ .hash = built.files[i].hash,
						       .size = built.files[i].size };
	buffer_init(&file, PAGE_BYTES_MAX);
	page_encode(&file, &page);
	for (int i = 0; i < ROOT_CHILD_COUNT; i++)
		root_children[i] = (struct page_child){ { { 1 } }, 100, true };
	root_children[ROOT_CHILD_INFO].hash = hash_of(buffer_bytes(&file));
	information_view_destroy(visit.shown.view);
	CHECK(information_view_create(&visit.shown.view, &options) == 0);
	information_view_open(visit.shown.view, (struct hash){ { 7 } }, &root);
	CHECK(information_view_give(visit.shown.view, root_children[ROOT_CHILD_INFO].hash,
				    buffer_bytes(&file)));
	CHECK(information_view_give(visit.shown.view, children[0].hash,
				    buffer_bytes(&built.database)));
	CHECK(words() != NULL);
	buffer_finish(&file);
	info_built_finish(&built);
}

static inline void begin_visitor(const char *language, bool off)
{
	visitor_init(
		&visit.visitor,
		&(struct visitor_options){ .idle_s = IDLE_S, .language = language, .off = off },
		&(struct visitor_env){ .shown = &visit.shown,
				       .eye = &visit.eye,
				       .tours = &visit.tours,
				       .listening = &visit.listening,
				       .tools = &visit.tools,
				       .back = &visit.back,
				       .counting = &visit.counting,
				       .redraw = &visit.redraw,
				       .ended = on_ended });
}

/* A kiosk whose first picture is on the panel and whose eye stands at home. */
static inline int begin_visit(void **state)
{
	const struct navigator_options options = { .box_max_m = { 10, 10, 10 },
						   .home_eye_m = { 5, -40, 5 },
						   .home_target_m = { 5, 5, 5 },
						   .fov_deg = 45 };
	char visits[100];

	if (set_up(state) != 0)
		return -1;
	memset(&visit, 0, sizeof(visit));
	now_ms = 1000000;
	visit.shown.frame.patches = 9;
	visit.viewport = (struct viewport){ .panel_width_px = 1920,
					    .panel_height_px = 1080,
					    .px_per_mm = 4 };
	show_words();
	eye_init(&visit.eye, &visit.shown);
	navigator_init(&visit.eye.navigator, &options);
	visit.eye.ready = true;
	eye_aim(&visit.eye, &visit.viewport, now_ms);
	snprintf(visits, sizeof(visits), "%s/visits.csv", folder);
	CHECK(counting_init(&visit.counting, &visit.shown, visits, NULL) == 0);
	tools_init(&visit.tools, &(struct tools_env){ &visit.shown, &visit.eye, &visit.viewport,
						      &visit.anchors, &visit.redraw });
	tour_player_init(&visit.tours, &(struct tour_player_env){ &visit.shown, &visit.eye,
								  &visit.counting, &visit.redraw });
	back_init(&visit.back, &(struct back_env){ &visit.shown, &visit.eye, &visit.tours });
	CHECK(listening_init(&visit.listening,
			     &(struct listening_env){ &visit.shown, &visit.redraw }, 50) == 0);
	visit.actions =
		(struct actions){ &visit.shown, &visit.eye,  &visit.viewport, &visit.tours,
				  &visit.tools, &visit.back, &visit.counting, &visit.listening };
	begin_visitor(NULL, false);
	return 0;
}

static inline int end_visit(void **state)
{
	listening_finish(&visit.listening);
	counting_finish(&visit.counting);
	exhibit_close(&visit.shown);
	return tear_down(state);
}

/* Lets time pass, then gives the visitor a turn. */
static inline void after(int64_t ms)
{
	now_ms += ms;
	visitor_turn(&visit.visitor, visit.is_dark);
}

#define VISITED(test) cmocka_unit_test_setup_teardown(test, begin_visit, end_visit)

#endif
