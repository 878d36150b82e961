/* Copies and decodes a recording in a sandboxed child. libogg finds pages and packets. */
#include "curator/pages/sound_import.h"

#include <errno.h>
#include <ogg/ogg.h>
#include <string.h>

#include "base/shared_memory.h"
#include "pipeline/content/spoken_sound.h"
#include "pipeline/import/sandbox.h"
#include "storage/info_spoken.h"

enum { TIMEOUT_S = 30, MEMORY_MB = 256 };

/* ---- what is copied */

/* No vendor, no comments (RFC 7845, section 5.2). */
static const uint8_t no_tags[16] = "OpusTags";

struct copy {
	struct buffer *out;
	ogg_stream_state in, made; /* of the stream that is copied; made: its two headers, anew */
	bool is_begun;
	uint32_t packets;  /* headers that came, of two */
	uint32_t sequence; /* of the next page */
};

static int write_page(struct copy *copy, ogg_page *page)
{
	for (int i = 0; i < 4; i++)
		page->header[18 + i] = (uint8_t)(copy->sequence >> 8 * i);
	copy->sequence++;
	ogg_page_checksum_set(page);
	buffer_put(copy->out, page->header, (size_t)page->header_len);
	buffer_put(copy->out, page->body, (size_t)page->body_len);
	return copy->out->error;
}

/* Writes a header as the only packet of a page. */
static int write_header(struct copy *copy, ogg_packet packet)
{
	ogg_page page;

	packet.e_o_s = 0;
	packet.granulepos = 0;
	if (ogg_stream_packetin(&copy->made, &packet) < 0)
		return -ENOMEM;
	return ogg_stream_flush(&copy->made, &page) ? write_page(copy, &page) : -EBADMSG;
}

static void end(struct copy *copy)
{
	if (copy->is_begun) {
		ogg_stream_clear(&copy->in);
		ogg_stream_clear(&copy->made);
	}
	copy->is_begun = false;
}

/* Files may be chains of streams, one after the other. */
static int begin(struct copy *copy, const ogg_page *page)
{
	const int serial = ogg_page_serialno(page);

	end(copy);
	if (ogg_stream_init(&copy->in, serial) < 0)
		return -ENOMEM;
	if (ogg_stream_init(&copy->made, serial) < 0) {
		ogg_stream_clear(&copy->in);
		return -ENOMEM;
	}
	copy->is_begun = true;
	copy->packets = copy->sequence = 0;
	return 0;
}

static int take_header(struct copy *copy, ogg_packet packet)
{
	const char *const name = copy->packets == 0 ? "OpusHead" : "OpusTags";

	if (packet.bytes < 8 || memcmp(packet.packet, name, 8) != 0)
		return -EBADMSG;
	if (copy->packets++ == 1) {
		packet.packet = (unsigned char *)no_tags;
		packet.bytes = sizeof(no_tags);
	}
	return write_header(copy, packet);
}

/* Pages of the headers; after each of the two a page ends. */
static int take_headers(struct copy *copy, ogg_page *page)
{
	ogg_packet packet;
	int rc = ogg_stream_pagein(&copy->in, page) < 0 ? -EBADMSG : 0, got = 0;

	if (rc == 0)
		got = ogg_stream_packetout(&copy->in, &packet);
	if (rc == 0 && got > 0)
		rc = take_header(copy, packet);
	if (rc == 0 && (got < 0 || (got > 0 && ogg_stream_packetpeek(&copy->in, NULL) != 0)))
		rc = -EBADMSG;
	return rc;
}

static int take_page(struct copy *copy, ogg_page *page)
{
	const bool is_sound = page->body_len >= 8 && memcmp(page->body, "OpusHead", 8) == 0;
	int rc = 0;

	if (ogg_page_bos(page) && !is_sound)
		return 0; /* another kind of stream */
	if (ogg_page_bos(page))
		rc = begin(copy, page);
	if (rc < 0 || !copy->is_begun || ogg_page_serialno(page) != copy->in.serialno)
		return rc;
	return copy->packets < 2 ? take_headers(copy, page) : write_page(copy, page);
}

int sound_import_copy(struct buffer *out, struct bytes file)
{
	struct copy copy = { .out = out };
	ogg_sync_state sync;
	ogg_page page;
	char *room;
	int rc = 0, got;

	if (file.size == 0) /* libogg calls that a lack of memory */
		return -EBADMSG;
	ogg_sync_init(&sync);
	room = ogg_sync_buffer(&sync, (long)file.size);
	if (room) {
		memcpy(room, file.data, file.size);
		ogg_sync_wrote(&sync, (long)file.size);
	} else {
		rc = -ENOMEM;
	}
	/* -1: bytes were left out until the next page */
	while (rc == 0 && (got = ogg_sync_pageout(&sync, &page)) != 0)
		rc = got > 0 ? take_page(&copy, &page) : 0;
	if (rc == 0 && copy.packets < 2)
		rc = -EBADMSG;
	end(&copy);
	ogg_sync_clear(&sync);
	return rc;
}

/* ---- in the child */

struct job {
	struct bytes file; /* the child has a copy of the parent's memory */
	size_t room, size; /* of the result */
	uint8_t result[];
};

static int work(void *shared, struct diagnostics *diagnostics)
{
	struct job *job = shared;
	struct buffer copy;
	uint32_t duration_ms;
	int rc;

	(void)diagnostics;
	buffer_init(&copy, job->room);
	rc = sound_import_copy(&copy, job->file);
	if (rc == 0)
		rc = spoken_sound_measure(buffer_bytes(&copy), false, &duration_ms);
	if (rc == 0) {
		memcpy(job->result, copy.data, copy.size);
		job->size = copy.size;
	}
	buffer_finish(&copy);
	return rc;
}

static int run(struct buffer *out, struct bytes file)
{
	struct sandbox_options options = { .limits.timeout_s = TIMEOUT_S };
	const size_t room = INFO_SPOKEN_BYTES_MAX;
	struct job *job = shared_memory_create(sizeof(*job) + room);
	struct diagnostics told = { 0 };
	int rc;

	if (!job)
		return -ENOMEM;
	options.limits.memory_bytes = sandbox_memory_bytes((uint64_t)MEMORY_MB << 20);
	job->file = file;
	job->room = room;
	rc = sandbox_run(work, job, &options, "recording", &told);
	if (rc == 0 && job->size > room) /* the child may have been taken over */
		rc = -EBADMSG;
	if (rc == 0) {
		buffer_put(out, job->result, job->size);
		rc = out->error;
	}
	shared_memory_destroy(job, sizeof(*job) + room);
	diagnostics_finish(&told);
	return rc;
}

int sound_import(struct buffer *out, struct bytes file, struct diagnostics *diagnostics)
{
	const int rc = run(out, file);

	if (rc == -EFBIG)
		diagnostics_add(diagnostics, rc, NULL, 0,
				"the recording is longer than ten minutes: divide the text");
	else if (rc == -ENOMEM)
		diagnostics_add(diagnostics, rc, NULL, 0,
				"the recording needs more memory than there is: try again");
	else if (rc < 0)
		diagnostics_add(diagnostics, rc, NULL, 0,
				"this is not a complete Ogg Opus file with one or two channels: "
				"encode it with 'opusenc --bitrate 24'");
	return rc;
}
