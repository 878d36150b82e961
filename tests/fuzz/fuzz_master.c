/* The index of a master (the hierarchy at home in .work), as it is and with the right hash at its
 * end; the groups' file beside it has 64 KiB. */
#include "pipeline/hierarchy/master.h"
#include "pipeline/hierarchy/master_cut.h"
#include "tests/fuzz/scratch.h"

enum { STAMP_AT = 8 };

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static void begin(void)
{
	static const uint8_t zero[64 << 10];
	char name[HASH_HEX_BYTES + 16], hex[HASH_HEX_BYTES];

	if (scratch[0])
		return;
	scratch_begin();
	hash_to_hex((struct hash){ { 0 } }, hex);
	snprintf(name, sizeof(name), "groups-%s", hex);
	scratch_write(name, zero, sizeof(zero));
}

static void read_it(const uint8_t *data, size_t size)
{
	struct master_cut cut;
	struct master *master;
	struct buffer object;

	scratch_write("index", data, size);
	if (master_open(&master, scratch, NULL) < 0)
		return;
	buffer_init(&object, 1 << 20);
	for (uint32_t g = 0; g < master->hierarchy.group_count && g < 20; g++) {
		buffer_clear(&object);
		if (master_read_group(master, g, &object) == 0 && object.size != master->sizes[g])
			abort();
	}
	buffer_finish(&object);
	if (master_cut_create(&cut, master, 0.5) == 0) {
		if (hierarchy_check(&cut.hierarchy) < 0)
			abort();
		master_cut_finish(&cut);
	}
	master_destroy(master);
}

/* Of one stamp always, as it names the groups' file. */
int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	uint8_t *copy = malloc(size + 1), *sealed;

	begin();
	if (!copy)
		abort();
	memcpy(copy, data, size);
	if (size >= STAMP_AT + HASH_BYTES)
		memset(copy + STAMP_AT, 0, HASH_BYTES);
	read_it(copy, size);
	sealed = scratch_sealed(copy, size, false);
	if (sealed)
		read_it(sealed, size);
	free(sealed);
	free(copy);
	return 0;
}
