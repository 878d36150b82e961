/* Terminals to be judged: one that is well, and figures of it changed one at a time. */
#ifndef GOPURA_TESTS_HEALTH_SNAPSHOTS_H
#define GOPURA_TESTS_HEALTH_SNAPSHOTS_H

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "health/gather.h"
#include "tests/check.h"

#define WELL_KIOSK                                                                                   \
	"gopura_kiosk_uptime_seconds 90000\ngopura_kiosk_starts_total 1\n"                           \
	"gopura_kiosk_frames_total 5000\ngopura_kiosk_late_frames_total 12\n"                        \
	"gopura_kiosk_last_frame_age_seconds 4.5\ngopura_kiosk_picture 1\n"                          \
	"gopura_kiosk_touch_devices 1\ngopura_kiosk_clock_trusted 1\n"                               \
	"gopura_kiosk_release_sequence 7\ngopura_kiosk_resident_bytes 150000000\n"                   \
	"gopura_kiosk_release_info{root=\"e8df\",name=\"Prasat <b>\"} 1\n"                           \
	"gopura_kiosk_texture_bytes 1000\ngopura_kiosk_texture_budget_bytes 4000\n"                  \
	"gopura_kiosk_geometry_bytes 1000\ngopura_kiosk_geometry_budget_bytes 4000\n"                \
	"gopura_kiosk_trust_root_version 2\ngopura_kiosk_trust_root_expires_at_seconds 1900000000\n" \
	"gopura_kiosk_trust_timestamp_expires_at_seconds 1702000000\n"                               \
	"gopura_kiosk_trust_release_expires_at_seconds 1800000000\n"                                 \
	"gopura_kiosk_gl_info{renderer=\"V3D 7.1\"} 1\n"
#define WELL_FETCH                                                                                 \
	"gopura_fetch_uptime_seconds 90000\ngopura_fetch_starts_total 1\n"                         \
	"gopura_fetch_online 1\ngopura_fetch_offline_since_seconds 0\n"                            \
	"gopura_fetch_kiosk_connected 1\ngopura_fetch_cache_refused_total 0\n"                     \
	"gopura_fetch_received_bytes_total 5000000\ngopura_fetch_errors_total 1\n"                 \
	"gopura_fetch_requests_total 100\ngopura_fetch_cache_bytes 1000000\n"                      \
	"gopura_fetch_cache_budget_bytes 4000000\ngopura_fetch_resident_bytes 15000000\n"

enum { NOW_S = 1700000000 };

static inline void set_text(struct snapshot *snapshot, enum program program, const char *text)
{
	buffer_clear(&snapshot->answers[program].text);
	buffer_put(&snapshot->answers[program].text, text, strlen(text));
	snapshot->answers[program].rc = 0;
}

static inline void make_well(struct snapshot *snapshot)
{
	snapshot_init(snapshot);
	set_text(snapshot, PROGRAM_KIOSK, WELL_KIOSK);
	set_text(snapshot, PROGRAM_FETCH, WELL_FETCH);
	snapshot->taken_ms = 1;
	snapshot->taken_wall_s = NOW_S;
	snapshot->machine = (struct machine){
		.name = "terminal-<3>",
		.slot = "A",
		.is_set_up = true,
		.uptime_s = 90100,
		.temperature_c = 55,
		.memory_bytes = 2e9,
		.memory_free_bytes = 1e9,
		.data_bytes = 8e9,
		.data_free_bytes = 6e9,
		.written_bytes = 3e9,
	};
}

/* Replaces "NAME VALUE" of the program's figures; "" for text takes the figure away. */
static inline void change(struct snapshot *snapshot, enum program program, const char *name,
			  const char *text)
{
	struct buffer *metrics = &snapshot->answers[program].text;
	static char changed[METRICS_BYTES_MAX];
	const char *at, *end;

	buffer_put_u8(metrics, '\0');
	at = strstr((char *)metrics->data, name);
	CHECK(at);
	end = strchr(at, '\n');
	snprintf(changed, sizeof(changed), "%.*s%s%s", (int)(at - (char *)metrics->data),
		 metrics->data, text, *text ? end : end + 1);
	set_text(snapshot, program, changed);
}

#endif
