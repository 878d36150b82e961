/* The tokens of VRML97: words, numbers, strings and marks, each with its line. */
#include "pipeline/scene/vrml_lexer.h"

#include <string.h>

static bool is_blank(char c)
{
	return c == ' ' || c == '\t' || c == '\r' || c == '\n' || c == ',';
}

/* What may stand in a name; bytes of UTF-8 may. */
static bool is_name(char c)
{
	return (unsigned char)c > ' ' && c != 127 && !strchr("\"#',.[]\\{}", c);
}

static void skip_blanks(struct vrml_lexer *lexer)
{
	for (; is_blank(*lexer->at) || *lexer->at == '#'; lexer->at++) {
		if (*lexer->at == '#')
			lexer->at += strcspn(lexer->at, "\r\n");
		if (*lexer->at == '\0')
			return;
		lexer->line += *lexer->at == '\n';
	}
}

static void read_string(struct vrml_lexer *lexer, struct vrml_token *token)
{
	const char *end = lexer->at + 1;
	unsigned line = lexer->line;

	for (; *end && *end != '"'; end++) {
		end += *end == '\\' && end[1];
		line += *end == '\n';
	}
	token->text = lexer->at + 1;
	token->length = (size_t)(end - token->text);
	token->kind = *end ? VRML_STRING : VRML_BAD;
	if (*end) {
		lexer->at = end + 1;
		lexer->line = line;
	}
}

struct vrml_token vrml_next(struct vrml_lexer *lexer)
{
	struct vrml_token token = { .kind = VRML_BAD, .length = 1 };
	const char *c;

	skip_blanks(lexer);
	c = lexer->at;
	token.text = c;
	token.line = lexer->line;
	if (*c == '\0') {
		token.kind = VRML_END;
		token.length = 0;
		return token;
	}
	if (*c == '"') {
		read_string(lexer, &token);
		return token;
	}
	if (strchr("+-0123456789", *c) || (*c == '.' && c[1] >= '0' && c[1] <= '9')) {
		token.kind = VRML_NUMBER;
		token.length = 1 + strspn(c + 1, "+-.0123456789abcdefABCDEFxX");
	} else if (strchr("[]{}.", *c)) {
		token.kind = VRML_MARK;
	} else if (is_name(*c)) {
		token.kind = VRML_WORD;
		while (is_name(c[token.length]))
			token.length++;
	} else {
		return token;
	}
	lexer->at += token.length;
	return token;
}

bool vrml_token_is(const struct vrml_token *token, const char *text)
{
	return (token->kind == VRML_WORD || token->kind == VRML_MARK) &&
	       strlen(text) == token->length && memcmp(text, token->text, token->length) == 0;
}
