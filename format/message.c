/* Encodes and decodes the packets of the socket between kiosk and fetcher, and checks each field's
 * range. */
#include "format/message.h"

#include <errno.h>
#include <string.h>

#include "format/page.h"

/* A packet is one byte with the kind, then the fields in the order in which message_encode() writes
 * them. The last field of MESSAGE_OBJECT and MESSAGE_META is the rest of the packet. */

static void put_hash(struct buffer *out, struct hash hash)
{
	buffer_put(out, hash.bytes, HASH_BYTES);
}

static struct hash get_hash(struct reader *reader)
{
	struct bytes view = reader_bytes(reader, HASH_BYTES);
	struct hash hash = { { 0 } };

	for (size_t i = 0; i < view.size; i++)
		hash.bytes[i] = view.data[i];
	return hash;
}

static void put_want(struct buffer *out, const struct message_want *want)
{
	put_hash(out, want->hash);
	put_hash(out, want->page);
	buffer_put_u32(out, want->offset);
	buffer_put_u32(out, want->size);
	buffer_put_u32(out, want->priority);
}

static void get_want(struct message_want *out, struct reader *reader)
{
	out->hash = get_hash(reader);
	out->page = get_hash(reader);
	out->offset = reader_u32(reader);
	out->size = reader_u32(reader);
	out->priority = reader_u32(reader);
}

static void put_status(struct buffer *out, const struct message_status *status)
{
	buffer_put_u8(out, status->online);
	buffer_put_u32(out, status->wanted);
	buffer_put_u64(out, status->received_bytes);
	buffer_put_u64(out, status->cache_bytes);
	buffer_put_u64(out, status->cache_budget_bytes);
	buffer_put_u64(out, status->offline_since_s);
}

static void get_status(struct message_status *out, struct reader *reader)
{
	out->online = reader_u8(reader);
	out->wanted = reader_u32(reader);
	out->received_bytes = reader_u64(reader);
	out->cache_bytes = reader_u64(reader);
	out->cache_budget_bytes = reader_u64(reader);
	out->offline_since_s = reader_u64(reader);
}

bool message_name_is_fine(const char *name)
{
	static const char allowed[] =
		"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789._-~%/";
	const size_t size = strlen(name);

	return size > 0 && size <= MESSAGE_NAME_MAX && strspn(name, allowed) == size &&
	       name[0] != '.' && name[0] != '/' && name[size - 1] != '/' && !strstr(name, "/.") &&
	       !strstr(name, "//");
}

static void put_name(struct buffer *out, const char *name)
{
	const size_t size = strlen(name);

	buffer_put_u8(out, (uint8_t)size);
	buffer_put(out, name, size);
}

/* Returns whether it is a name. */
static bool get_name(char out[MESSAGE_NAME_MAX + 1], struct reader *reader)
{
	const struct bytes name = reader_bytes(reader, reader_u8(reader));

	if (name.size > MESSAGE_NAME_MAX)
		return false;
	if (name.size > 0)
		memcpy(out, name.data, name.size);
	out[name.size] = '\0';
	return strlen(out) == name.size && message_name_is_fine(out);
}

/* Puts the rest of the packet; its size must not exceed the maximum of its kind. */
static void put_rest(struct buffer *out, struct bytes rest, size_t most)
{
	if (rest.size > most && !out->error)
		out->error = -EFBIG;
	buffer_put(out, rest.data, rest.size);
}

void message_encode(struct buffer *out, const struct message *message)
{
	buffer_put_u8(out, (uint8_t)message->kind);
	switch (message->kind) {
	case MESSAGE_RELEASE:
		put_hash(out, message->release.root);
		buffer_put_u32(out, message->release.root_bytes);
		buffer_put_u8(out, message->release.also);
		break;
	case MESSAGE_WANT:
		put_want(out, &message->want);
		break;
	case MESSAGE_DROP:
		put_hash(out, message->drop);
		break;
	case MESSAGE_KEEP:
		put_hash(out, message->keep);
		break;
	case MESSAGE_ASK_META:
		buffer_put_u32(out, message->period_s);
		break;
	case MESSAGE_SYNC:
		break;
	case MESSAGE_TRUST:
		buffer_put_u32(out, message->root_version);
		break;
	case MESSAGE_ASK_FILE:
		buffer_put_u8(out, (uint8_t)message->file.source);
		buffer_put_u32(out, message->file.bytes_max);
		put_name(out, message->file.name);
		break;
	case MESSAGE_FILE:
		buffer_put_u8(out, (uint8_t)message->file.source);
		buffer_put_u8(out, (uint8_t)message->file.answer);
		put_name(out, message->file.name);
		put_rest(out, message->file.bytes, MESSAGE_META_BYTES_MAX);
		break;
	case MESSAGE_SYNCED:
		buffer_put_u8(out, message->synced);
		break;
	case MESSAGE_OBJECT:
		put_hash(out, message->object.hash);
		buffer_put_u32(out, message->object.size);
		put_rest(out, message->object.bytes, MESSAGE_INLINE_MAX);
		break;
	case MESSAGE_MISSING:
		put_hash(out, message->missing.hash);
		buffer_put_u8(out, (uint8_t)message->missing.reason);
		break;
	case MESSAGE_META:
		buffer_put_u8(out, (uint8_t)message->meta.role);
		buffer_put_u8(out, (uint8_t)message->meta.source);
		buffer_put_u32(out, message->meta.version);
		put_rest(out, message->meta.bytes, MESSAGE_META_BYTES_MAX);
		break;
	case MESSAGE_STATUS:
		put_status(out, &message->status);
		break;
	}
}

static bool size_in_range(uint32_t size)
{
	return size > 0 && size <= OBJECT_BYTES_MAX;
}

static bool object_in_range(const struct message *message)
{
	size_t inlined = message->object.bytes.size;

	if (inlined > MESSAGE_INLINE_MAX || !size_in_range(message->object.size))
		return false;
	return inlined == 0 || inlined == message->object.size;
}

static bool get_asked_file(struct message_file *out, struct reader *reader)
{
	const uint8_t source = reader_u8(reader);

	out->source = (enum meta_source)source;
	out->bytes_max = reader_u32(reader);
	return source <= META_FROM_STICK && out->bytes_max > 0 &&
	       out->bytes_max <= MESSAGE_META_BYTES_MAX && get_name(out->name, reader);
}

static bool get_file(struct message_file *out, struct reader *reader)
{
	const uint8_t source = reader_u8(reader), answer = reader_u8(reader);

	out->source = (enum meta_source)source;
	out->answer = (enum file_answer)answer;
	if (source > META_FROM_STICK || answer > FILE_TOO_LARGE || !get_name(out->name, reader))
		return false;
	out->bytes = reader_bytes(reader, reader_left(reader));
	return (out->bytes.size > 0) == (out->answer == FILE_IS_HERE) &&
	       out->bytes.size <= MESSAGE_META_BYTES_MAX;
}

/* Reads the fields of *out's kind. Returns true if each is in its range. */
static bool get_fields(struct message *out, struct reader *reader)
{
	uint8_t small, source;

	switch (out->kind) {
	case MESSAGE_RELEASE:
		out->release.root = get_hash(reader);
		out->release.root_bytes = reader_u32(reader);
		small = reader_u8(reader);
		out->release.also = small == 1;
		return small <= 1 && size_in_range(out->release.root_bytes) &&
		       !hash_is_zero(out->release.root);
	case MESSAGE_WANT:
		get_want(&out->want, reader);
		return size_in_range(out->want.size) && !hash_is_zero(out->want.hash);
	case MESSAGE_DROP:
		out->drop = get_hash(reader);
		return true;
	case MESSAGE_KEEP:
		out->keep = get_hash(reader);
		return !hash_is_zero(out->keep);
	case MESSAGE_ASK_META:
		out->period_s = reader_u32(reader);
		return out->period_s <= MESSAGE_PERIOD_S_MAX;
	case MESSAGE_SYNC:
		return true;
	case MESSAGE_TRUST:
		out->root_version = reader_u32(reader);
		return true;
	case MESSAGE_ASK_FILE:
		return get_asked_file(&out->file, reader);
	case MESSAGE_FILE:
		return get_file(&out->file, reader);
	case MESSAGE_SYNCED:
		small = reader_u8(reader);
		out->synced = small == 1;
		return small <= 1;
	case MESSAGE_OBJECT:
		out->object.hash = get_hash(reader);
		out->object.size = reader_u32(reader);
		out->object.bytes = reader_bytes(reader, reader_left(reader));
		return object_in_range(out);
	case MESSAGE_MISSING:
		out->missing.hash = get_hash(reader);
		small = reader_u8(reader);
		out->missing.reason = (enum missing_reason)small;
		return small <= MISSING_DAMAGED;
	case MESSAGE_META:
		small = reader_u8(reader);
		out->meta.role = (enum meta_role)small;
		source = reader_u8(reader);
		out->meta.source = (enum meta_source)source;
		out->meta.version = reader_u32(reader);
		out->meta.bytes = reader_bytes(reader, reader_left(reader));
		return small <= META_TIMESTAMP && source <= META_FROM_STICK &&
		       out->meta.bytes.size > 0 && out->meta.bytes.size <= MESSAGE_META_BYTES_MAX;
	case MESSAGE_STATUS:
		get_status(&out->status, reader);
		return out->status.online <= 1;
	}
	return false; /* an unknown kind */
}

int message_decode(struct message *out, struct bytes packet)
{
	struct reader reader;

	reader_init(&reader, packet);
	*out = (struct message){ .kind = (enum message_kind)reader_u8(&reader) };
	if (!get_fields(out, &reader) || reader.failed || reader_left(&reader) > 0)
		return -EBADMSG;
	return 0;
}
