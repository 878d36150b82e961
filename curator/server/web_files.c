/* Lets the assembler include the files, so that the program needs no folder of them. The Makefile
 * makes the zipped ones. */
#include "curator/server/web_files.h"

#include <string.h>

#define INCLUDE_BYTES(symbol, file)                                                                \
	__asm__(".section .rodata\n"                                                               \
		".global " symbol "\n"                                                             \
		".global " symbol "_end\n" symbol ":\n"                                            \
		".incbin \"" file "\"\n" symbol "_end:\n"                                          \
		".byte 0\n"                                                                        \
		".previous\n")

#define INCLUDE_FILE(name, path, file, type, is_open)                                              \
	INCLUDE_BYTES("web_" #name, "curator/web/" file);                                          \
	INCLUDE_BYTES("web_" #name "_zipped", "curator/web/" file ".gz");                          \
	extern const uint8_t web_##name[], web_##name##_end[], web_##name##_zipped[],              \
		web_##name##_zipped_end[];

#define HTML   "text/html; charset=utf-8"
#define SCRIPT "text/javascript; charset=utf-8"
#define STYLE  "text/css; charset=utf-8"

/* A line for each file: a name for the linker, the path of a request, the file, its type,
 * and whether those who are not signed in get it. */
#define FILES(FILE)                                                                                \
	FILE(page, "/", "index.html", HTML, false)                                                 \
	FILE(script, "/curator.js", "curator.js", SCRIPT, true)                                    \
	FILE(api, "/api.js", "api.js", SCRIPT, true)                                               \
	FILE(account, "/account.js", "account.js", SCRIPT, true)                                   \
	FILE(browser, "/browser.js", "browser.js", SCRIPT, true)                                   \
	FILE(publish, "/publish.js", "publish.js", SCRIPT, true)                                   \
	FILE(publish_style, "/publish.css", "publish.css", STYLE, true)                            \
	FILE(information, "/information", "information.html", HTML, false)                         \
	FILE(information_script, "/information.js", "information.js", SCRIPT, true)                \
	FILE(information_style, "/information.css", "information.css", STYLE, true)                \
	FILE(about, "/about.js", "about.js", SCRIPT, true)                                         \
	FILE(clean, "/clean.js", "clean.js", SCRIPT, true)                                         \
	FILE(drops, "/drops.js", "drops.js", SCRIPT, true)                                         \
	FILE(editor, "/editor.js", "editor.js", SCRIPT, true)                                      \
	FILE(eye, "/eye.js", "eye.js", SCRIPT, true)                                               \
	FILE(history, "/history.js", "history.js", SCRIPT, true)                                   \
	FILE(marked_part, "/marked_part.js", "marked_part.js", SCRIPT, true)                       \
	FILE(measure, "/measure.js", "measure.js", SCRIPT, true)                                   \
	FILE(part_list, "/part_list.js", "part_list.js", SCRIPT, true)                             \
	FILE(pictures, "/pictures.js", "pictures.js", SCRIPT, true)                                \
	FILE(preview, "/preview.js", "preview.js", SCRIPT, true)                                   \
	FILE(problems, "/problems.js", "problems.js", SCRIPT, true)                                \
	FILE(tours, "/tours", "tours.html", HTML, false)                                           \
	FILE(tours_script, "/tours.js", "tours.js", SCRIPT, true)                                  \
	FILE(documents, "/documents.js", "documents.js", SCRIPT, true)                             \
	FILE(sound, "/sound.js", "sound.js", SCRIPT, true)                                         \
	FILE(stop_list, "/stop_list.js", "stop_list.js", SCRIPT, true)                             \
	FILE(tour_merge, "/tour_merge.js", "tour_merge.js", SCRIPT, true)                          \
	FILE(tour_player, "/tour_player.js", "tour_player.js", SCRIPT, true)                       \
	FILE(tours_style, "/tours.css", "tours.css", STYLE, true)                                  \
	FILE(style, "/curator.css", "curator.css", STYLE, true)                                    \
	FILE(sign_in, "/sign-in", "sign_in.html", HTML, true)                                      \
	FILE(sign_in_script, "/sign_in.js", "sign_in.js", SCRIPT, true)                            \
	FILE(sign_in_style, "/sign_in.css", "sign_in.css", STYLE, true)

FILES(INCLUDE_FILE)

#define ROW(name, path, file, type, is_open)                                                       \
	{ path, type, is_open, { web_##name, 0 }, { web_##name##_zipped, 0 }, "" },
#define ENDS(name, path, file, type, is_open) { web_##name##_end, web_##name##_zipped_end },

static struct web_file files[] = { FILES(ROW) };

/* The sizes are known to the linker alone. */
static void measure(void)
{
	static const uint8_t *const ends[][2] = { FILES(ENDS) };

	for (size_t n = 0; n < ARRAY_COUNT(files); n++) {
		files[n].bytes.size = (size_t)(ends[n][0] - files[n].bytes.data);
		files[n].zipped.size = (size_t)(ends[n][1] - files[n].zipped.data);
		hash_to_hex(hash_of(files[n].bytes), files[n].tag);
	}
}

const struct web_file *web_file_find(const char *path)
{
	if (!files[0].tag[0])
		measure();
	for (size_t n = 0; n < ARRAY_COUNT(files); n++)
		if (strcmp(path, files[n].path) == 0)
			return &files[n];
	return NULL;
}
