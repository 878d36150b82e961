/* What a streaming mesh takes: bench_stream MASTER SHARE, as bench_patch. Once of the cut that is
 * published as one, once of everything that is published at its finest. Processor time of one
 * thread, the best of several rounds; JSON to standard output. */
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/clock.h"
#include "format/stream.h"
#include "pipeline/release/publish_hierarchy.h"
#include "pipeline/release/publish_stream.h"

enum { ROUNDS = 10 };

static void need_ok(int rc, const char *what)
{
	if (rc < 0) {
		fprintf(stderr, "%s: %s\n", what, strerror(-rc));
		exit(EXIT_FAILURE);
	}
}

/* Sets best to the shortest times of decoding all, undoing all, and applying all again. */
static void time_decoder(int64_t best_us[3], struct bytes stream, uint32_t record_count)
{
	for (int i = 0; i < 3; i++)
		best_us[i] = INT64_MAX;
	for (int round = 0; round < ROUNDS; round++) {
		struct stream_decoder *decoder;
		int64_t at_us[4];

		need_ok(stream_decoder_create(&decoder), "decoder");
		at_us[0] = clock_thread_us();
		need_ok(stream_decoder_advance(decoder, stream), "decode");
		at_us[1] = clock_thread_us();
		stream_decoder_show(decoder, 0);
		at_us[2] = clock_thread_us();
		stream_decoder_show(decoder, record_count);
		at_us[3] = clock_thread_us();
		for (int i = 0; i < 3; i++)
			if (at_us[i + 1] - at_us[i] < best_us[i])
				best_us[i] = at_us[i + 1] - at_us[i];
		stream_decoder_destroy(decoder);
	}
}

static void measure(const char *name, const struct stream_cut *cut, double step_m)
{
	static struct stream_stats stats;
	int64_t best_us[3], encode_us = clock_thread_us();
	struct buffer out;
	struct bytes stream;
	size_t base_bytes;

	buffer_init(&out, OBJECT_BYTES_MAX);
	need_ok(stream_make(&out, &stats, cut->vertices, cut->vertex_count,
			    (const uint32_t(*)[3])cut->triangles, cut->triangle_count,
			    &stream_publish_options),
		"stream");
	encode_us = clock_thread_us() - encode_us;
	stream = buffer_bytes(&out);
	base_bytes = stream_start_bytes(stream);
	time_decoder(best_us, stream, stats.record_count);
	printf("\"%s\": {\"vertices\": %" PRIu32 ", \"triangles\": %" PRIu32
	       ", \"base_vertices\": %" PRIu32 ", \"base_triangles\": %" PRIu32
	       ", \"records\": %" PRIu32 ", \"pieces\": %" PRIu32
	       ", \"bytes\": %zu, \"base_bytes\": %zu, \"bytes_a_record\": %.2f, "
	       "\"bytes_a_record_before_coding\": %d, \"decoded_and_applied_per_s\": %.0f, "
	       "\"undone_per_s\": %.0f, \"applied_per_s\": %.0f, \"encode_s\": %.2f, "
	       "\"errors_m\": [",
	       name, cut->vertex_count, cut->triangle_count, stats.base_vertices,
	       stats.base_triangles, stats.record_count, stats.piece_count, stream.size, base_bytes,
	       (double)(stream.size - base_bytes) / stats.record_count, STREAM_RECORD_BYTES,
	       1e6 * stats.record_count / (double)best_us[0],
	       1e6 * stats.record_count / (double)best_us[1],
	       1e6 * stats.record_count / (double)best_us[2], (double)encode_us / 1e6);
	for (uint32_t i = 0; i <= stream_block_count(stats.record_count); i++)
		printf("%s%.4f", i ? ", " : "", stats.errors[i] * step_m);
	printf("]}");
	buffer_finish(&out);
}

int main(int argc, char **argv)
{
	struct published_patches published;
	struct object_store *objects;
	struct page_child hierarchy;
	struct stream_cut cut;
	struct master *master;

	if (argc != 3) {
		fprintf(stderr, "usage: bench_stream MASTER SHARE\n");
		return EXIT_FAILURE;
	}
	need_ok(master_open(&master, argv[1], NULL), argv[1]);
	need_ok(object_store_create(&objects), "objects");
	need_ok(publish_hierarchy(objects, master, strtod(argv[2], NULL), &hierarchy, &published),
		"publishing");
	printf("{");
	for (int whole = 0; whole < 2; whole++) {
		need_ok(stream_cut_read(&cut, objects, &master->lattice, &hierarchy,
					whole ? UINT32_MAX : STREAM_CUT_TRIANGLES),
			"cut");
		measure(whole ? "whole" : "published", &cut, master->lattice.step_m);
		printf(whole ? "}\n" : ", ");
		stream_cut_finish(&cut);
	}
	object_store_destroy(objects);
	master_destroy(master);
	return EXIT_SUCCESS;
}
