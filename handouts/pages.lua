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
  { Code = code },   -- after the columns, which count its letters
  { Pandoc = title },
  { Pandoc = one_of_each_id },
  { Pandoc = scripts },
}
