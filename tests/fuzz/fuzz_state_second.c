/* state.db's second file, as it is and with the right hash at its end: what is taken up is written
 * and read again as the same record. */
#include "storage/state_record.h"
#include "tests/fuzz/scratch.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static void read_it(const uint8_t *data, size_t size)
{
	struct record record, again;
	struct hash hash, hash_again;

	scratch_write("state.second", data, size);
	record_init(&record);
	record_init(&again);
	if (record_read_second(&record, scratch_path("state")) == 0 &&
	    (record_write_second(&record, scratch_path("again")) < 0 ||
	     record_read_second(&again, scratch_path("again")) < 0 ||
	     record_hash(&hash, &record) < 0 || record_hash(&hash_again, &again) < 0 ||
	     !hash_equal(hash, hash_again)))
		abort();
	record_finish(&record);
	record_finish(&again);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	uint8_t *sealed = scratch_sealed(data, size, false);

	scratch_begin();
	read_it(data, size);
	if (sealed)
		read_it(sealed, size);
	free(sealed);
	return 0;
}
