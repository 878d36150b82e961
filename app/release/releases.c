/* Passes the events of fetcher and updater on to the sessions, and the verdict of a trial to the
 * updater. */
#include "app/release/releases.h"

#include "base/clock.h"
#include "base/log.h"

/* ---- events of the updater */

static void on_begin(void *data, struct hash root, uint32_t root_bytes)
{
	struct releases *releases = data;

	sessions_begin(&releases->sessions, root, root_bytes);
	redraw_ask(releases->options.sessions.redraw);
}

static void on_remembered(void *data, struct hash root, int rc)
{
	struct releases *releases = data;

	sessions_remembered(&releases->sessions, root, rc);
}

static void on_ask(void *data, const struct message_file *file)
{
	struct releases *releases = data;

	net_client_ask_file(releases->net, file);
}

/* ---- events of the fetcher */

static void on_object(void *data, struct hash hash, struct bytes bytes)
{
	struct releases *releases = data;

	wants_arrived(&releases->wants, hash);
	sessions_give(&releases->sessions, hash, bytes);
	if (releases->options.object_arrived)
		releases->options.object_arrived(releases->options.sessions.data);
	redraw_ask(releases->options.sessions.redraw);
}

static void on_file(void *data, const struct message_file *file)
{
	struct releases *releases = data;

	updater_file(releases->updater, file);
	net_client_trust(releases->net, updater_root_version(releases->updater));
}

static void on_missing(void *data, struct hash hash, enum missing_reason reason)
{
	static const char *const why[] = { "offline", "not on the server", "damaged" };
	char hex[HASH_HEX_BYTES];

	(void)data;
	hash_to_hex(hash, hex);
	log_debug("app", "object %s is missing: %s", hex, why[reason]);
}

static void on_meta(void *data, enum meta_role role, uint32_t version, struct bytes bytes,
		    enum meta_source source)
{
	struct releases *releases = data;

	updater_meta(releases->updater, role, version, bytes, source);
	net_client_trust(releases->net, updater_root_version(releases->updater));
}

static void on_synced(void *data, bool done)
{
	struct releases *releases = data;

	sessions_synced(&releases->sessions, done);
}

static void on_status(void *data, const struct message_status *status)
{
	struct releases *releases = data;

	if (status->online != releases->status.online)
		log_info("app", status->online ? "the museum server answers"
					       : "the museum server does not answer: offline");
	releases->status = *status;
	if (releases->options.status_arrived)
		releases->options.status_arrived(releases->options.sessions.data);
}

/* ---- start and end */

int releases_init(struct releases *releases, const struct releases_options *options)
{
	const struct updater_options updater = {
		.state_path = options->state_path,
		.trust_path = options->trust_path,
		.target = options->target,
		.begin = on_begin,
		.remembered = on_remembered,
		.ask = on_ask,
		.data = releases,
	};
	struct net_client_options net = options->net;
	struct sessions_options sessions = options->sessions;
	int rc = updater_create(&releases->updater, &updater);

	releases->options = *options;
	releases->options.state_path = releases->options.trust_path = NULL; /* borrowed */
	releases->options.target = NULL;
	releases->options.net = (struct net_client_options){ 0 };
	if (rc < 0)
		return rc;
	net.root_version = updater_root_version(releases->updater);
	net.events = (struct net_client_events){ .object = on_object,
						 .missing = on_missing,
						 .meta = on_meta,
						 .file = on_file,
						 .synced = on_synced,
						 .status = on_status };
	net.data = releases;
	rc = net_client_create(&releases->net, &net);
	if (rc < 0)
		return rc;
	wants_init(&releases->wants, releases->net);
	sessions.net = releases->net;
	sessions.updater = releases->updater;
	sessions.wants = &releases->wants;
	return sessions_init(&releases->sessions, &sessions);
}

void releases_finish(struct releases *releases)
{
	updater_destroy(releases->updater);
	net_client_destroy(releases->net);
	sessions_finish(&releases->sessions);
}

void releases_start(struct releases *releases)
{
	updater_start(releases->updater);
}

/* ---- the loop */

static struct trial_sight sight_of(const struct releases *releases, int64_t frame_ms, bool is_dark)
{
	const struct session *shown = &releases->sessions.shown;

	return (struct trial_sight){
		.on_trial = updater_on_trial(releases->updater),
		.has_before = updater_has_before(releases->updater),
		.is_replaced = releases->sessions.coming.exhibit.scene,
		.is_pictured = shown->exhibit.frame.patches > 0,
		.is_broken = exhibit_is_broken(&shown->exhibit),
		.is_complete = shown->root_here && releases->wants.said_count == 0,
		.is_dark = is_dark,
		.frame_ms = frame_ms,
	};
}

void releases_turn(struct releases *releases, int64_t frame_ms, bool is_dark)
{
	const struct trial_sight sight = sight_of(releases, frame_ms, is_dark);

	switch (trial_judge(&releases->trial, &sight, clock_now_ms())) {
	case TRIAL_GOES_ON:
		break;
	case TRIAL_PASSED:
		updater_prove(releases->updater);
		break;
	case TRIAL_FAILED_BROKEN:
		updater_fall_back(releases->updater, "objects of it cannot be decoded");
		break;
	case TRIAL_FAILED_BLANK:
		updater_fall_back(releases->updater, "nothing of it was to be seen for a minute");
		break;
	}
	if (releases_wait_ms(releases) == 0) /* it is drawn as part of a frame */
		redraw_ask(releases->options.sessions.redraw);
}

int releases_wait_ms(const struct releases *releases)
{
	return sessions_wait_ms(&releases->sessions);
}

int releases_trial_wait_ms(const struct releases *releases, int64_t frame_ms, bool is_dark)
{
	const struct trial_sight sight = sight_of(releases, frame_ms, is_dark);

	return trial_wait_ms(&releases->trial, &sight, clock_now_ms());
}

void releases_on_release(void *data, const struct exhibit_change *change)
{
	struct releases *releases = data;

	(void)change;
	trial_begin(&releases->trial, clock_now_ms());
}
