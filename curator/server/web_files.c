/* Lets the assembler include the files, so that the program needs no folder of them. */
#include "curator/server/web_files.h"

#include <string.h>

#define INCLUDE_FILE(name, file)                                                                   \
	__asm__(".section .rodata\n"                                                               \
		".global web_" #name "\n"                                                          \
		".global web_" #name "_end\n"                                                      \
		"web_" #name ":\n"                                                                 \
		".incbin \"curator/web/" file "\"\n"                                               \
		"web_" #name "_end:\n"                                                             \
		".byte 0\n"                                                                        \
		".previous\n");                                                                    \
	extern const uint8_t web_##name[], web_##name##_end[]

INCLUDE_FILE(page, "index.html");
INCLUDE_FILE(script, "curator.js");
INCLUDE_FILE(style, "curator.css");

const struct web_file *web_file_find(const char *path)
{
	static struct web_file files[] = {
		{ "/", "text/html; charset=utf-8", { web_page, 0 } },
		{ "/curator.js", "text/javascript; charset=utf-8", { web_script, 0 } },
		{ "/curator.css", "text/css; charset=utf-8", { web_style, 0 } },
	};

	files[0].bytes.size = (size_t)(web_page_end - web_page);
	files[1].bytes.size = (size_t)(web_script_end - web_script);
	files[2].bytes.size = (size_t)(web_style_end - web_style);
	for (size_t n = 0; n < ARRAY_COUNT(files); n++)
		if (strcmp(path, files[n].path) == 0)
			return &files[n];
	return NULL;
}
