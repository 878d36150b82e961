/* gopura-fetch: brings objects; network and cache, no devices. */
#include <stdio.h>
#include <string.h>

int main(int argc, char **argv)
{
	if (argc > 1 && strcmp(argv[1], "--version") == 0) {
		puts("gopura-fetch " GOPURA_VERSION);
		return 0;
	}
	fprintf(stderr, "gopura-fetch: see gopura-fetch --help\n");
	return 2;
}
