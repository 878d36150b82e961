/* Tokens, messages, lists and names: what the parser of VRML97 is built of. */
#include "pipeline/scene/vrml_scope.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/array.h"

enum { LIST_MAX = 1 << 26, WORD_SHOWN = 40 };

/* ---- messages */

int vrml_fail_memory(struct vrml_parser *parser)
{
	return VRML_FAIL(parser, -EFBIG, parser->scope->lexer.line,
			 "the scene needs more memory than %d MiB; split it into several files",
			 (int)(VRML_MEMORY_BYTES_MAX >> 20));
}

int vrml_shown(const struct vrml_token *token)
{
	return token->length < WORD_SHOWN ? (int)token->length : WORD_SHOWN;
}

int vrml_fail_token(struct vrml_parser *parser, const struct vrml_token *token, const char *wanted)
{
	if (token->kind == VRML_END)
		return VRML_FAIL(
			parser, -EBADMSG, token->line,
			"the file ends where %s should stand; copy it again from the source",
			wanted);
	return VRML_FAIL(parser, -EBADMSG, token->line, "'%.*s' stands where %s should; correct it",
			 vrml_shown(token), token->text, wanted);
}

/* ---- tokens */

struct vrml_token vrml_take_any(struct vrml_parser *parser)
{
	return vrml_next(&parser->scope->lexer);
}

struct vrml_token vrml_peek(struct vrml_parser *parser)
{
	struct vrml_lexer lexer = parser->scope->lexer;

	return vrml_next(&lexer);
}

bool vrml_take(struct vrml_parser *parser, const char *text)
{
	struct vrml_token token = vrml_peek(parser);

	if (!vrml_token_is(&token, text))
		return false;
	vrml_take_any(parser);
	return true;
}

int vrml_expect(struct vrml_parser *parser, const char *mark)
{
	struct vrml_token token = vrml_take_any(parser);

	return vrml_token_is(&token, mark) ? 0 : vrml_fail_token(parser, &token, mark);
}

int vrml_take_name(struct vrml_parser *parser, const char **out, const char *wanted)
{
	struct vrml_token token = vrml_take_any(parser);

	if (token.kind != VRML_WORD)
		return vrml_fail_token(parser, &token, wanted);
	*out = arena_text(&parser->scene->arena, token.text, token.length);
	return *out ? 0 : vrml_fail_memory(parser);
}

/* ---- lists */

int vrml_push(struct vrml_parser *parser, struct vrml_list *list, const void *item, size_t bytes)
{
	int rc = array_reserve(&list->items, &list->room, (uint64_t)list->count + 1, LIST_MAX,
			       bytes);

	if (rc < 0)
		return vrml_fail_memory(parser);
	memcpy((uint8_t *)list->items + list->count++ * bytes, item, bytes);
	return 0;
}

void *vrml_settle(struct vrml_parser *parser, struct vrml_list *list, size_t bytes)
{
	void *kept = arena_alloc(&parser->scene->arena, list->count * bytes + 1);

	if (kept && list->count > 0)
		memcpy(kept, list->items, list->count * bytes);
	free(list->items);
	list->items = NULL;
	list->room = 0;
	return kept;
}

/* ---- values */

int vrml_read_number(struct vrml_parser *parser, const struct vrml_type *type, void *out)
{
	struct vrml_token token = vrml_take_any(parser);
	bool is_whole = type->base != VRML_FLOATS;
	char *end = NULL;

	if (token.kind == VRML_NUMBER && is_whole) {
		bool is_hex = token.length > 2 && token.text[0] == '0' &&
			      (token.text[1] == 'x' || token.text[1] == 'X');
		long long value = strtoll(token.text, &end, is_hex ? 16 : 10);

		if (end != token.text + token.length || value > UINT32_MAX || value < INT32_MIN)
			return vrml_fail_token(parser, &token, "a whole number");
		*(int32_t *)out = (int32_t)(uint32_t)value;
		return 0;
	}
	if (token.kind == VRML_NUMBER)
		*(float *)out = strtof(token.text, &end);
	if (!end || end != token.text + token.length || !isfinite(*(float *)out))
		return vrml_fail_token(parser, &token, "a number");
	return 0;
}

int vrml_read_bool(struct vrml_parser *parser, int32_t *out)
{
	struct vrml_token token = vrml_take_any(parser);

	*out = vrml_token_is(&token, "TRUE");
	return *out || vrml_token_is(&token, "FALSE")
		       ? 0
		       : vrml_fail_token(parser, &token, "TRUE or FALSE");
}

int vrml_read_string(struct vrml_parser *parser, const char **out)
{
	struct vrml_token token = vrml_take_any(parser);
	size_t length = 0;
	char *text;

	if (token.kind != VRML_STRING)
		return vrml_fail_token(parser, &token, "a text in quotes");
	text = arena_text(&parser->scene->arena, token.text, token.length);
	if (!text)
		return vrml_fail_memory(parser);
	for (size_t i = 0; i < token.length; i++) {
		i += text[i] == '\\' && i + 1 < token.length;
		text[length++] = text[i];
	}
	text[length] = '\0';
	*out = text;
	return 0;
}

/* ---- DEF and USE */

static map_key hash_of(const char *name)
{
	uint64_t hash = 0xcbf29ce484222325u; /* FNV-1a */

	for (; *name; name++)
		hash = (hash ^ (uint8_t)*name) * 0x100000001b3u;
	return hash;
}

struct vrml_definition *vrml_find_definition(const struct vrml_scope *scope, const char *name)
{
	struct vrml_definition *definition = map_get_pointer(&scope->definitions, hash_of(name));

	while (definition && strcmp(definition->name, name) != 0)
		definition = definition->before;
	return definition;
}

int vrml_define(struct vrml_parser *parser, const char *name, struct vrml_definition **out)
{
	struct vrml_definition *definition =
		arena_alloc(&parser->scene->arena, sizeof(*definition));

	if (!definition)
		return vrml_fail_memory(parser);
	definition->name = name;
	definition->before = map_get_pointer(&parser->scope->definitions, hash_of(name));
	*out = definition;
	return map_set(&parser->scope->definitions, hash_of(name),
		       (uint64_t)(uintptr_t)definition) < 0
		       ? vrml_fail_memory(parser)
		       : 0;
}
