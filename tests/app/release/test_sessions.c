/* When a release is loaded, stored and shown, without scenes, disk and network: these are the
 * test's. */
#include "app/release/sessions.h"

#include <errno.h>
#include <string.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include "base/clock.h"
#include "format/page.h"
#include "tests/check.h"

enum { S = 1000, MINUTE = 60 * S, DAY_S = 86400 };

static const struct hash first = { { 1 } }, second = { { 2 } };

static int64_t now_ms;

/* What the sessions are told, and what they asked for. */
static struct {
	bool settled;  /* pictures are complete */
	int drawn;     /* pictures of the next release */
	int remembers; /* requests to store a release */
	struct hash remembered;
	int opened; /* releases */
	int syncs;
	int visitor_left_ms;
	int fds[4]; /* of the scenes */
	size_t fd_count;
} museum;

static struct sessions sessions;
static struct eye eye;
static struct redraw redraw;
static struct wants wants;

int64_t clock_now_ms(void)
{
	return now_ms;
}

/* Midnight is where the monotonic clock begins. */
int64_t clock_wall_s(void)
{
	return now_ms / S;
}

bool clock_wall_is_set(void)
{
	return true;
}

bool daily_holds(const struct daily *daily, int64_t wall_s)
{
	const int minute = (int)(wall_s % DAY_S / 60);

	return daily->from_min == daily->until_min ||
	       (minute >= daily->from_min && minute < daily->until_min);
}

/* ---- releases whose root page is here at once, and scenes that are only numbers */

static struct root_page root_page = { .name = "Temple" };

int exhibit_open(struct exhibit *exhibit, struct hash root, uint32_t root_bytes,
		 const struct scene_options *scene, const struct information_view_options *view)
{
	(void)scene;
	(void)view;
	museum.opened++;
	*exhibit = (struct exhibit){ .scene = (struct scene *)&root_page,
				     .root = root,
				     .root_bytes = root_bytes };
	return 0;
}

void exhibit_close(struct exhibit *exhibit)
{
	*exhibit = (struct exhibit){ 0 };
}

bool exhibit_is_broken(const struct exhibit *exhibit)
{
	(void)exhibit;
	return false;
}

const struct info *exhibit_info(const struct exhibit *exhibit)
{
	return (const struct info *)exhibit->scene;
}

const struct root_page *scene_root(const struct scene *scene)
{
	return (const struct root_page *)scene;
}

void scene_give(struct scene *scene, struct hash hash, struct bytes object)
{
	(void)scene;
	(void)hash;
	(void)object;
}

/* Another for each, as epoll takes none twice. */
int scene_fd(const struct scene *scene)
{
	(void)scene;
	CHECK(museum.fd_count < ARRAY_COUNT(museum.fds));
	return museum.fds[museum.fd_count++] = eventfd(0, EFD_CLOEXEC);
}

int scene_dispatch(struct scene *scene)
{
	(void)scene;
	return 0;
}

size_t scene_wants(struct scene *scene, struct message_want *list, size_t most)
{
	(void)scene;
	(void)list;
	(void)most;
	return 0;
}

bool scene_lacked_memory(const struct scene *scene)
{
	(void)scene;
	return false;
}

bool scene_awaits_image(const struct scene *scene)
{
	(void)scene;
	return false;
}

void scene_draw(struct scene *scene, const struct camera *camera, const struct scene_mark *mark,
		struct scene_frame *out)
{
	(void)scene;
	(void)camera;
	(void)mark;
	museum.drawn++;
	*out = (struct scene_frame){ .patches = 9, .settled = museum.settled };
}

int page_decode(struct page *page, struct bytes bytes)
{
	(void)bytes;
	*page = (struct page){ 0 };
	return 0;
}

void page_finish(struct page *page)
{
	(void)page;
}

bool page_is(struct bytes bytes)
{
	(void)bytes;
	return true;
}

void information_view_open(struct information_view *view, struct hash root, const struct page *page)
{
	(void)view;
	(void)root;
	(void)page;
}

bool information_view_give(struct information_view *view, struct hash hash, struct bytes object)
{
	(void)view;
	(void)hash;
	(void)object;
	return false;
}

uint32_t information_view_wants(const struct information_view *view, struct message_want *out,
				uint32_t most)
{
	(void)view;
	(void)out;
	(void)most;
	return 0;
}

void eye_take_bounds(struct eye *taken)
{
	taken->ready = true;
}

int gl_target_create(struct gl_target *out, int width_px, int height_px)
{
	CHECK(width_px > 0 && height_px > 0);
	out->framebuffer = 1;
	return 0;
}

void gl_target_destroy(struct gl_target *target)
{
	target->framebuffer = 0;
}

void gl_target_bind(const struct gl_target *target)
{
	(void)target;
}

void glClear(GLbitfield mask)
{
	(void)mask;
}

/* ---- the fetcher and the updater */

void net_client_add_release(struct net_client *client, struct hash root, uint32_t root_bytes)
{
	(void)client;
	(void)root;
	(void)root_bytes;
}

void net_client_keep(struct net_client *client, struct hash hash)
{
	(void)client;
	(void)hash;
}

void net_client_sync(struct net_client *client)
{
	(void)client;
	museum.syncs++;
}

bool updater_next_on_stick(const struct updater *updater)
{
	(void)updater;
	return false;
}

void updater_refuse(struct updater *updater, struct hash root, const char *why)
{
	(void)updater;
	(void)root;
	(void)why;
}

void updater_remember(struct updater *updater, struct hash root)
{
	(void)updater;
	museum.remembers++;
	museum.remembered = root;
}

void wants_begin(struct wants *list)
{
	(void)list;
}

void wants_add(struct wants *list, const struct message_want *want)
{
	(void)list;
	(void)want;
}

void wants_later(struct wants *list)
{
	(void)list;
}

bool wants_say(struct wants *list)
{
	(void)list;
	return true;
}

/* ---- the kiosk */

static int visitor_left_ms(void *data)
{
	(void)data;
	return museum.visitor_left_ms;
}

static void on_changed(void *data, const struct exhibit_change *change)
{
	(void)data;
	(void)change;
}

static int set_up(void **state)
{
	const struct sessions_options options = { .wants = &wants,
						  .eye = &eye,
						  .redraw = &redraw,
						  .visitor_left_ms = visitor_left_ms,
						  .changed = on_changed };

	(void)state;
	now_ms = 10 * MINUTE;
	memset(&museum, 0, sizeof(museum));
	museum.settled = true;
	eye = (struct eye){ .camera = { .width_px = 640, .height_px = 360 } };
	return sessions_init(&sessions, &options);
}

static int tear_down(void **state)
{
	(void)state;
	sessions_finish(&sessions);
	while (museum.fd_count > 0)
		close(museum.fds[--museum.fd_count]);
	return 0;
}

/* What the kiosk does for each frame, but for drawing. */
static void after(int64_t ms)
{
	now_ms += ms;
	sessions_warm(&sessions);
	sessions_keep_first(&sessions, now_ms);
	sessions_ask(&sessions);
}

static void begin(struct hash root)
{
	sessions_begin(&sessions, root, 100);
	after(0);
}

static void root_arrives(struct hash root)
{
	sessions_give(&sessions, root, (struct bytes){ NULL, 0 });
	after(0);
}

/* The first release, with a picture, stored. */
static void show_first(void)
{
	begin(first);
	root_arrives(first);
	CHECK(museum.remembers == 1 && hash_equal(museum.remembered, first));
	sessions_remembered(&sessions, first, 0);
	sessions.shown.exhibit.frame = (struct scene_frame){ .patches = 9, .settled = true };
	after(0);
	CHECK(museum.syncs == 1);
	sessions_synced(&sessions, true);
	CHECK(sessions_wait_ms(&sessions) == -1);
}

static void shows_the_next_once_it_is_complete_and_stored(void **state)
{
	(void)state;
	show_first();
	begin(second);
	root_arrives(second);
	CHECK(museum.drawn == 1 && museum.syncs == 2);
	sessions_synced(&sessions, true);
	CHECK(museum.remembers == 2 && hash_equal(museum.remembered, second));
	CHECK(hash_equal(sessions.shown.exhibit.root, first));
	sessions_remembered(&sessions, second, 0);
	CHECK(hash_equal(sessions.shown.exhibit.root, second));
	after(60 * MINUTE);
	CHECK(museum.remembers == 2 && museum.syncs == 2);
}

static void waits_for_who_came_while_it_was_stored(void **state)
{
	(void)state;
	show_first();
	begin(second);
	root_arrives(second);
	CHECK(museum.syncs == 2);
	museum.visitor_left_ms = 75 * S;
	sessions_synced(&sessions, true);
	CHECK(museum.remembers == 1);
	after(sessions_wait_ms(&sessions));
	CHECK(museum.syncs == 2 && sessions_wait_ms(&sessions) == 75 * S);
	museum.visitor_left_ms = 0;
	after(75 * S);
	CHECK(museum.syncs == 3);
	sessions_synced(&sessions, true);
	CHECK(museum.remembers == 2 && hash_equal(museum.remembered, second));
}

static void tries_again_to_store_the_next_where_the_disk_is_full(void **state)
{
	(void)state;
	show_first();
	begin(second);
	root_arrives(second);
	sessions_synced(&sessions, true);
	sessions_remembered(&sessions, second, -ENOSPC);
	after(sessions_wait_ms(&sessions));
	CHECK(museum.syncs == 3);
	sessions_synced(&sessions, true);
	CHECK(museum.remembers == 3);
	sessions_remembered(&sessions, second, 0);
	CHECK(hash_equal(sessions.shown.exhibit.root, second));
}

static void tries_again_to_store_what_is_shown_where_the_disk_is_full(void **state)
{
	(void)state;
	begin(first);
	root_arrives(first);
	for (int n = 2; n < 5; n++) {
		sessions_remembered(&sessions, first, -ENOSPC);
		CHECK(sessions_wait_ms(&sessions) > 0);
		after(sessions_wait_ms(&sessions));
		CHECK(museum.remembers == n && hash_equal(museum.remembered, first));
	}
	sessions_remembered(&sessions, first, 0);
	CHECK(sessions_wait_ms(&sessions) == -1);
	/* And its objects. */
	sessions.shown.exhibit.frame = (struct scene_frame){ .patches = 9, .settled = true };
	after(0);
	sessions_synced(&sessions, false);
	after(0);
	CHECK(museum.syncs == 1);
	after(sessions_wait_ms(&sessions));
	CHECK(museum.syncs == 2);
	sessions_synced(&sessions, true);
	CHECK(sessions_wait_ms(&sessions) == -1);
}

static void sync_next(bool done)
{
	const int before = museum.syncs;

	after(sessions_wait_ms(&sessions));
	CHECK(museum.syncs == before + 1);
	sessions_synced(&sessions, done);
}

/* Of what the disk refused the fetcher has nothing, so a release that lacks it is not stored. */
static void loads_the_next_again_where_the_disk_refused_some_of_it(void **state)
{
	(void)state;
	show_first();
	begin(second);
	root_arrives(second);
	sessions_synced(&sessions, false);
	sync_next(false);
	CHECK(museum.opened == 2);
	sync_next(true);
	CHECK(museum.opened == 3 && museum.remembers == 1);
	root_arrives(second);
	CHECK(museum.syncs == 5);
	/* A disk that goes on refusing some costs the line no release each time. */
	sessions_synced(&sessions, false);
	sync_next(true);
	CHECK(museum.opened == 3 && museum.remembers == 1);
	now_ms += 60 * MINUTE;
	sync_next(true);
	CHECK(museum.opened == 4 && museum.remembers == 1);
	root_arrives(second);
	sessions_synced(&sessions, true);
	CHECK(museum.remembers == 2 && hash_equal(museum.remembered, second));
	sessions_remembered(&sessions, second, 0);
	CHECK(hash_equal(sessions.shown.exhibit.root, second));
}

static void shows_what_there_is_of_the_next_after_a_minute(void **state)
{
	(void)state;
	museum.settled = false;
	show_first();
	begin(second);
	root_arrives(second);
	after(MINUTE);
	CHECK(museum.syncs == 1);
	after(S);
	CHECK(museum.syncs == 2);
}

static void gives_the_next_its_minute_from_when_it_may_load(void **state)
{
	(void)state;
	museum.settled = false;
	show_first();
	sessions.options.download = (struct daily){ .from_min = 120, .until_min = 180 };
	begin(second);
	CHECK(sessions.coming_held);
	now_ms = 120 * MINUTE;
	CHECK(sessions_wait_ms(&sessions) == 0);
	after(0);
	CHECK(!sessions.coming_held);
	root_arrives(second);
	after(MINUTE);
	CHECK(museum.syncs == 1 && museum.drawn > 0);
	after(S);
	CHECK(museum.syncs == 2);
}

#define MUSEUM(test) cmocka_unit_test_setup_teardown(test, set_up, tear_down)

int main(void)
{
	const struct CMUnitTest tests[] = {
		MUSEUM(shows_the_next_once_it_is_complete_and_stored),
		MUSEUM(waits_for_who_came_while_it_was_stored),
		MUSEUM(tries_again_to_store_the_next_where_the_disk_is_full),
		MUSEUM(tries_again_to_store_what_is_shown_where_the_disk_is_full),
		MUSEUM(loads_the_next_again_where_the_disk_refused_some_of_it),
		MUSEUM(shows_what_there_is_of_the_next_after_a_minute),
		MUSEUM(gives_the_next_its_minute_from_when_it_may_load),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
