/* A chunk is handed over when it is full, and what is left at the end. */
#include "format/jpeg_to_buffer.h"

static struct jpeg_to_buffer *destination_of(j_compress_ptr codec)
{
	return (struct jpeg_to_buffer *)codec->dest; /* its first member */
}

static void start_chunk(j_compress_ptr codec)
{
	struct jpeg_to_buffer *to = destination_of(codec);

	to->manager.next_output_byte = to->chunk;
	to->manager.free_in_buffer = sizeof(to->chunk);
}

static boolean put_whole_chunk(j_compress_ptr codec)
{
	struct jpeg_to_buffer *to = destination_of(codec);

	buffer_put(to->out, to->chunk, sizeof(to->chunk));
	start_chunk(codec);
	return TRUE;
}

static void put_last_chunk(j_compress_ptr codec)
{
	struct jpeg_to_buffer *to = destination_of(codec);

	buffer_put(to->out, to->chunk, sizeof(to->chunk) - to->manager.free_in_buffer);
}

void jpeg_to_buffer(struct jpeg_to_buffer *to, j_compress_ptr codec, struct buffer *out)
{
	to->manager.init_destination = start_chunk;
	to->manager.empty_output_buffer = put_whole_chunk;
	to->manager.term_destination = put_last_chunk;
	to->out = out;
	codec->dest = &to->manager;
}
