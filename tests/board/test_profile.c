#include "board/profile.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "tests/check.h"

static int read_text(struct profile *out, const char *text)
{
	char path[] = "/tmp/gopura-profile-XXXXXX";
	int fd = mkstemp(path), rc;

	CHECK(fd >= 0 && write(fd, text, strlen(text)) == (ssize_t)strlen(text));
	close(fd);
	rc = profile_read(out, path);
	unlink(path);
	return rc;
}

static void without_a_file_gives_the_default(void **state)
{
	struct profile profile;

	(void)state;
	CHECK(profile_read(&profile, NULL) == 0);
	CHECK(memcmp(&profile, &profile_default, sizeof(profile)) == 0);
	CHECK(profile_read(&profile, "/nonexistent/board.ini") == -ENOENT);
}

static void reads_what_a_board_says_and_keeps_the_rest(void **state)
{
	struct profile profile;

	(void)state;
	CHECK(read_text(&profile, "; a small board\n[panel]\nrotation = 90\n[touch]\n"
				  "matrix = 0 1 0 -1 0 1\n[render]\ntexture_mib = 32\n"
				  "error_px = 3.5\n") == 0);
	CHECK(profile.rotation_deg == 90);
	CHECK(profile.matrix[1] == 1 && profile.matrix[3] == -1);
	CHECK(profile.texture_mib == 32 && profile.error_px == 3.5f);
	CHECK(profile.triangles == profile_default.triangles);
}

static void refuses_what_does_not_do(void **state)
{
	static const char *const bad[] = {
		"[panel]\nrotation = 45\n",
		"[panel]\nrotation = upright\n",
		"[panel]\ncolour = 3\n",
		"[render]\ntexture_mib = 1\n",
		"[render]\ntriangles = 1e99\n",
		"[touch]\nmatrix = 1 0 0 0 1\n",
		"[touch]\nmatrix = 1 0 0 0 1 0 0\n",
		"nonsense\n",
		"[render]\nworkers = 1.5\n",
		"[render]\nerror_px = nan\n",
		"[render]\nthrift = 46\n", /* a name that was used before */
	};

	(void)state;
	for (size_t i = 0; i < ARRAY_COUNT(bad); i++) {
		struct profile profile;

		if (read_text(&profile, bad[i]) != -EINVAL)
			fail_msg("taken: %s", bad[i]);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(without_a_file_gives_the_default),
		cmocka_unit_test(reads_what_a_board_says_and_keeps_the_rest),
		cmocka_unit_test(refuses_what_does_not_do),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
