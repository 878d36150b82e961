/* gopura-kiosk: panel and touch, no network. */
#include <stdio.h>
#include <string.h>

int main(int argc, char **argv)
{
	if (argc > 1 && strcmp(argv[1], "--version") == 0) {
		puts("gopura-kiosk " GOPURA_VERSION);
		return 0;
	}
	fprintf(stderr, "gopura-kiosk: see gopura-kiosk --help\n");
	return 2;
}
