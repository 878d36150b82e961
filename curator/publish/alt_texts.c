/* Walks through the HTML of pages with libxml2. */
#include "curator/publish/alt_texts.h"

#include <cjson/cJSON.h>
#include <dirent.h>
#include <libxml/HTMLparser.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/json_tree.h"

enum { PAGE_FILE_BYTES_MAX = 1 << 20 };

static bool is_described(xmlNode *image)
{
	xmlChar *text = xmlGetProp(image, (const xmlChar *)"alt");
	const bool good = text && text[strspn((const char *)text, " \t\r\n")];

	xmlFree(text);
	return good;
}

static void add(cJSON *list, const char *file, xmlNode *image)
{
	xmlChar *source = xmlGetProp(image, (const xmlChar *)"src");
	cJSON *row = cJSON_CreateObject();

	cJSON_AddStringToObject(row, "file", file);
	cJSON_AddNumberToObject(row, "line", (double)xmlGetLineNo(image));
	cJSON_AddStringToObject(row, "picture", source ? (const char *)source : "");
	json_append(list, row);
	xmlFree(source);
}

/* The next node in the order of the text; NULL after the last. */
static xmlNode *next_of(xmlNode *node)
{
	if (node->children)
		return node->children;
	while (node && !node->next)
		node = node->parent;
	return node ? node->next : NULL;
}

void alt_texts_of(struct cJSON *list, const char *file, struct bytes html)
{
	xmlDoc *document = htmlReadMemory((const char *)html.data, (int)html.size, NULL, "UTF-8",
					  HTML_PARSE_RECOVER | HTML_PARSE_NOERROR |
						  HTML_PARSE_NOWARNING | HTML_PARSE_NONET);

	for (xmlNode *node = document ? xmlDocGetRootElement(document) : NULL;
	     node && cJSON_GetArraySize(list) < ALT_TEXTS_MAX; node = next_of(node))
		if (node->type == XML_ELEMENT_NODE &&
		    xmlStrcasecmp(node->name, (const xmlChar *)"img") == 0 && !is_described(node))
			add(list, file, node);
	xmlFreeDoc(document);
}

static int is_page(const struct dirent *entry)
{
	const size_t bytes = strlen(entry->d_name);

	return entry->d_name[0] != '.' && bytes > 5 &&
	       strcmp(entry->d_name + bytes - 5, ".html") == 0;
}

static void look(cJSON *list, const char *folder, const char *name)
{
	char path[PATH_MAX], file[NAME_MAX + 8];
	struct buffer html;

	buffer_init(&html, PAGE_FILE_BYTES_MAX);
	snprintf(file, sizeof(file), "pages/%s", name);
	if (snprintf(path, sizeof(path), "%s/%s", folder, file) < (int)sizeof(path) &&
	    buffer_read_foreign(&html, path) == 0 && html.size > 0)
		alt_texts_of(list, file, buffer_bytes(&html));
	buffer_finish(&html);
}

void alt_texts_find(struct cJSON *list, const char *folder)
{
	char path[PATH_MAX];
	struct dirent **entries;
	int count;

	if (snprintf(path, sizeof(path), "%s/pages", folder) >= (int)sizeof(path))
		return;
	count = scandir(path, &entries, is_page, alphasort);
	for (int n = 0; n < count; n++) {
		look(list, folder, entries[n]->d_name);
		free(entries[n]);
	}
	if (count >= 0)
		free(entries);
}
