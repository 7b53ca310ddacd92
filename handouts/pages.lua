-- What a handout needs on its way from Markdown to a page or a PDF. Metadata: root, the way from the page to the source tree; alone, where the page lies without it.
local root = ''
local alone = false
local latex = FORMAT:match 'latex'

-- <a id="x"></a> is where "#x" leads, on paper too.
local function anchor(element)
  if element.format ~= 'html' then return nil end
  local id = element.text:match '^<a id="([%w-]+)">'
  if id then return pandoc.Span({}, { id = id }) end
  if element.text:match '^</a>' then return {} end
end

local function link(element)
  if alone and not element.target:match '^#' then return element.content end   -- beside a report lies nothing else
  local handout, rest = element.target:match '^([%w_]+)%.md(.*)$'
  if handout then
    element.target = handout .. (latex and '.pdf' or '.html') .. rest
  elseif not element.target:match '^#' and not element.target:match '^%a+:' then
    if latex then return element.content end   -- a file of the tree has no address on paper
    element.target = root .. element.target
  end
  return element
end

-- <!-- explore: NAME --> is where a page has the panel NAME of explore.js; paper has nothing there.
local explores = false
local function panel(element)
  local name = element.format == 'html' and not latex and element.text:match '^<!%-%- explore: (%w+) %-%->'
  if not name then return nil end
  explores = true
  return pandoc.RawBlock('html', '<div class="explore" data-panel="' .. name .. '"></div>')
end
local function script(document, name)
  local file = assert(io.open(PANDOC_SCRIPT_FILE:match '^(.*/)' .. name))
  table.insert(document.blocks, pandoc.RawBlock('html', '<script>\n' .. file:read 'a' .. '</script>'))
  file:close()
end
local function scripts(document)
  if latex then return nil end
  if explores then script(document, 'explore.js') end
  script(document, 'scrollers.js')
  return document
end

-- The first heading is the title; on paper it stays where it is, without a page's worth of white around it.
local function title(document)
  for i, block in ipairs(document.blocks) do
    if block.t == 'Header' and block.level == 1 then
      document.meta[latex and 'title-meta' or 'title'] = pandoc.MetaInlines(block.content)
      if not latex then table.remove(document.blocks, i) end
      break
    end
  end
  return document
end

-- A heading that has an anchor's id by its words is where the anchor leads: a page has an id once.
local function one_of_each_id(document)
  local headings = {}
  document:walk { Header = function(element) headings[element.identifier] = true end }
  return document:walk { Span = function(element)
    if #element.content == 0 and headings[element.identifier] then return {} end
  end }
end

-- A browser may break a line on either side of a formula: its brackets, quotes and full stop stay with it.
local function beside_formulas(inlines)
  if latex then return nil end
  local kept, i = pandoc.List {}, 1
  local opens = function(text) return text:match '[%(%[]$' or text:match '\u{201c}$' or text:match '\u{2018}$' end
  local closes = function(text) return text:match '^[%.,:;!%?%)%]]' or text:match '^\u{201d}' or text:match '^\u{2019}' end
  while i <= #inlines do
    local first, run = i, pandoc.List {}
    if inlines[i].t == 'Str' and opens(inlines[i].text) and inlines[i + 1] and inlines[i + 1].t == 'Math' then i = i + 1 end
    if inlines[i].t == 'Math' and inlines[i].mathtype == 'InlineMath' and inlines[i + 1] and inlines[i + 1].t == 'Str' and
       closes(inlines[i + 1].text) then i = i + 1 end
    for k = first, i do run:insert(inlines[k]) end
    kept:extend(#run > 1 and { pandoc.Span(run, { class = 'together' }) } or run)
    i = i + 1
  end
  return kept
end

-- Nor is an option broken behind its hyphens; a name breaks behind an underscore, a path behind a slash.
local function escaped(text) return (text:gsub('[&<>]', { ['&'] = '&amp;', ['<'] = '&lt;', ['>'] = '&gt;' })) end
local function whole_options(text)
  return (escaped(text):gsub('%-%-%w[%w-]*', '\1%0\2'))
end
local function spans(text) return (text:gsub('\1', '<span class="together">'):gsub('\2', '</span>')) end
local function command(element)
  if latex or (#element.text < 12 and not element.text:match '%-%-%w') then return nil end
  local text = whole_options(element.text):gsub('[/_]', '%0<wbr>'):gsub('::', '%0<wbr>')
  return pandoc.RawInline('html', '<code>' .. spans(text) .. '</code>')
end
local function commands(element)
  if latex or #element.classes > 0 or not element.text:match '%-%-%w' then return nil end
  return pandoc.RawBlock('html', '<pre><code>' .. spans(whole_options(element.text)) .. '</code></pre>')
end

-- A long command or path may break where a reader would break it.
local kEscapes = { ['\\'] = '\\textbackslash{}', ['{'] = '\\{', ['}'] = '\\}', ['$'] = '\\$', ['&'] = '\\&', ['%'] = '\\%', ['#'] = '\\#', ['_'] = '\\_', ['^'] = '\\^{}', ['~'] = '\\textasciitilde{}', ['-'] = '-{}' }
local function code(element)
  if not latex or #element.text < 12 then return nil end
  local text = element.text:gsub('[\\{}$&%%#_^~-]', kEscapes):gsub('[/,=:]', '%0\\allowbreak{}'):gsub('\\_', '\\_\\allowbreak{}')
  return pandoc.RawInline('latex', '\\texttt{' .. text .. '}')
end

-- Columns of a table share its width as their longest cells do, so that words break on paper; a page lays them out itself.
local function columns(element)
  if not latex then
    for i, spec in ipairs(element.colspecs) do element.colspecs[i] = { spec[1], nil } end
    for _, body in ipairs(element.bodies) do
      for _, row in ipairs(body.body) do
        for _, cell in ipairs(row.cells or row[2]) do   -- on a phone a sentence is wider than a word, "1, 2, 2, 4" is one line
          local words = pandoc.utils.stringify(pandoc.Div(cell.contents or cell[5] or {}))
          local letters, classes = utf8.len(words) or #words, (cell.attr or cell[1]).classes
          if letters > 24 then classes:insert 'long' elseif letters <= 12 then classes:insert 'short' end
        end
      end
    end
    return element
  end
  local longest = {}
  local function look(row)
    for i, cell in ipairs(row.cells or row[2]) do
      local words = pandoc.utils.stringify(pandoc.Div(cell.contents or cell[5] or {}))
      longest[i] = math.max(longest[i] or 8, math.min(60, utf8.len(words) or #words))
    end
  end
  for _, row in ipairs(element.head.rows or element.head[2]) do look(row) end
  for _, body in ipairs(element.bodies) do for _, row in ipairs(body.body) do look(row) end end
  local sum = 0
  for _, n in ipairs(longest) do sum = sum + n end
  if sum < 70 then return nil end
  for i, spec in ipairs(element.colspecs) do element.colspecs[i] = { spec[1], (longest[i] or 8) / sum } end
  return element
end

return {
  { Meta = function(meta)
      root = meta.root and pandoc.utils.stringify(meta.root) or ''
      alone = meta.alone ~= nil
    end },
  { RawInline = anchor, RawBlock = function(element) return panel(element) or anchor(element) end, Link = link, Table = columns },
  { Inlines = beside_formulas, Code = command, CodeBlock = commands },
  { Code = code },   -- after the columns, which count its letters
  { Pandoc = title },
  { Pandoc = one_of_each_id },
  { Pandoc = scripts },
}
