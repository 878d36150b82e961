/* Table of the languages' own names. */
#include "ui/endonym.h"

#include <string.h>

#include "base/compiler.h"

static const struct {
	const char *language, *name;
} endonyms[] = {
	{ "en", "English" },
	{ "fr", "Français" },
	{ "km", "ខ្មែរ" },
	{ "ja", "日本語" },
	{ "de", "Deutsch" },
	{ "es", "Español" },
	{ "it", "Italiano" },
	{ "pt", "Português" },
	{ "nl", "Nederlands" },
	{ "th", "ไทย" },
	{ "vi", "Tiếng Việt" },
	{ "lo", "ລາວ" },
	{ "my", "မြန်မာ" },
	{ "zh", "中文" },
	{ "ko", "한국어" },
	{ "ru", "Русский" },
	{ "ar", "العربية" },
	{ "hi", "हिन्दी" },
	{ "zh-Hans", "简体中文" },
	{ "zh-Hant", "繁體中文" },
	{ "zh-CN", "简体中文" },
	{ "zh-TW", "繁體中文" },
	{ "zh-HK", "繁體中文（香港）" },
	{ "pt-BR", "Português (Brasil)" },
	{ "id", "Bahasa Indonesia" },
	{ "ms", "Bahasa Melayu" },
	{ "tr", "Türkçe" },
	{ "he", "עברית" },
	{ "fa", "فارسی" },
	{ "ur", "اردو" },
	{ "ta", "தமிழ்" },
	{ "el", "Ελληνικά" },
	{ "uk", "Українська" },
	{ "bg", "Български" },
	{ "sr", "Српски" },
	{ "pl", "Polski" },
	{ "cs", "Čeština" },
	{ "sk", "Slovenčina" },
	{ "hu", "Magyar" },
	{ "ro", "Română" },
	{ "sl", "Slovenščina" },
	{ "hr", "Hrvatski" },
	{ "sv", "Svenska" },
	{ "da", "Dansk" },
	{ "nb", "Norsk" },
	{ "no", "Norsk" },
	{ "fi", "Suomi" },
	{ "et", "Eesti" },
	{ "lv", "Latviešu" },
	{ "lt", "Lietuvių" },
	{ "is", "Íslenska" },
	{ "ca", "Català" },
	{ "eu", "Euskara" },
	{ "gl", "Galego" },
	{ "ga", "Gaeilge" },
	{ "cy", "Cymraeg" },
	{ "ne", "नेपाली" },
	{ "mr", "मराठी" },
	{ "tl", "Tagalog" },
};

const char *ui_endonym(const char *language)
{
	for (size_t i = 0; i < ARRAY_COUNT(endonyms); i++)
		if (strcmp(endonyms[i].language, language) == 0)
			return endonyms[i].name;
	return language;
}
