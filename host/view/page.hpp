// The page of `rfmvo view`: one file, nothing from elsewhere. It draws what the server works out: no geometry in here
// but where things are on the screen.
#pragma once

namespace rfmvo::view {

inline constexpr const char* kPage = R"html(<!DOCTYPE html>
<html lang="en"><head><meta charset="utf-8"><meta name="viewport" content="width=device-width, initial-scale=1">
<title>rfmvo view</title><link rel="icon" href="data:,"><style>
:root{color-scheme:light dark;--bg:#f6f7f9;--card:#fff;--ink:#1c2430;--soft:#5d6878;--line:#dde2e9;--path:#8a94a3;
--good:#1668c7;--doubt:#c96a00;--bad:#c22f2f}
@media (prefers-color-scheme:dark){:root{--bg:#12161c;--card:#1a2028;--ink:#e6eaf0;--soft:#9aa5b4;--line:#2f3844;
--path:#8592a3;--good:#5aa5ff;--doubt:#f0a04b;--bad:#ff7d7d}}
*{box-sizing:border-box}body{margin:0;background:var(--bg);color:var(--ink);font:14px/1.45 system-ui,sans-serif}
header{padding:10px 16px;display:flex;gap:12px;align-items:baseline;flex-wrap:wrap}h1{font-size:1.1rem;margin:0}
#line{color:var(--soft);flex:1;min-width:12em}.well{color:var(--good)}.ill{color:var(--bad)}
main{display:grid;grid-template-columns:1fr 1fr;gap:12px;padding:0 16px 16px}
section{background:var(--card);border:1px solid var(--line);border-radius:10px;padding:10px 12px;min-width:0}
h2{font-size:.95rem;margin:0 0 6px}.wide{grid-column:1/-1}canvas{display:block;width:100%;border-radius:6px}
#picture{background:#000;aspect-ratio:4/3}#map{height:min(52vh,460px)}
table{border-collapse:collapse;width:100%;font-variant-numeric:tabular-nums;font-size:.86rem}
td,th{padding:2px 8px;text-align:right;border-bottom:1px solid var(--line);white-space:nowrap}th{color:var(--soft)}
td:first-child,th:first-child,td:nth-child(2),th:nth-child(2){text-align:left}.scroll{overflow:auto;max-height:50vh}
.CONVERGED{color:var(--good)}.MIRROR,.CIRCLE,.WEAK_GEOMETRY{color:var(--doubt)}.note{color:var(--soft);margin:4px 0}
dl{display:grid;grid-template-columns:auto 1fr;gap:2px 12px;margin:0}dt{color:var(--soft)}dd{margin:0}
@media (max-width:760px){main{grid-template-columns:1fr;padding:0 8px 8px}header{padding:8px}}
</style></head><body>
<header><h1>rfmvo</h1><b id="well">…</b><span id="line">waiting for the box</span></header>
<main>
<section><h2>Camera</h2><canvas id="picture" width="640" height="480"></canvas><p class="note" id="nopicture">No picture has
come yet: the box sends none, or they are in another log (--frames).</p></section>
<section><h2>Map from above</h2><canvas id="map"></canvas><p class="note">x to the right, y up, metres; ellipses hold the
tag with 95 % probability; hollow: another position that fits</p></section>
<section><h2>Health</h2><dl id="health"></dl></section>
<section><h2>Scale</h2><dl id="scale"></dl></section>
<section class="wide"><h2>Tags <span id="count"></span></h2><div class="scroll"><table><thead><tr><th>EPC</th>
<th>Status</th><th>x m</th><th>y m</th><th>z m</th><th>σx cm</th><th>σy cm</th><th>σz cm</th><th>Reads</th></tr></thead>
<tbody id="tags"></tbody></table></div></section>
</main><script>
'use strict';
const $=id=>document.getElementById(id),css=name=>getComputedStyle(document.documentElement).getPropertyValue(name).trim();
let image=null,overlay=null,map={paths:[],tags:[]},mapDue=false,pictureDue=false;
const label=epc=>epc.length>8?'…'+epc.slice(-6):epc;
function drawPicture(){
 pictureDue=false;const c=$('picture'),g=c.getContext('2d');
 const w=overlay&&overlay.width||image&&image.width||640,h=overlay&&overlay.height||image&&image.height||480;
 if(c.width!==w||c.height!==h){c.width=w;c.height=h;c.style.aspectRatio=w+'/'+h}
 g.fillStyle='#111';g.fillRect(0,0,w,h);if(image)g.drawImage(image,0,0,w,h);
 if(!overlay)return;g.font=Math.round(w/50)+'px system-ui,sans-serif';g.lineWidth=w/320;
 for(const t of overlay.tags){g.strokeStyle=g.fillStyle=t.ok?'#5aa5ff':'#f0a04b';g.beginPath();
  if(t.a<2*w){g.ellipse(t.x,t.y,Math.max(t.a,2),Math.max(t.b,2),t.angle,0,7);g.stroke()}
  g.beginPath();g.arc(t.x,t.y,w/200,0,7);g.fill();
  const text=label(t.epc)+' '+t.d.toFixed(1)+' m',x=t.x+w/90,y=t.y-w/110,colour=g.fillStyle;
  g.save();g.strokeStyle='#000b';g.lineWidth=w/160;g.lineJoin='round';g.strokeText(text,x,y);g.restore();g.fillStyle=colour;g.fillText(text,x,y)}
}
function drawMap(){
 mapDue=false;const c=$('map'),r=window.devicePixelRatio||1,W=c.clientWidth,H=c.clientHeight,g=c.getContext('2d');
 if(c.width!==W*r||c.height!==H*r){c.width=W*r;c.height=H*r}g.setTransform(r,0,0,r,0,0);g.clearRect(0,0,W,H);
 let x0=1e9,x1=-1e9,y0=1e9,y1=-1e9;const see=(x,y)=>{x0=Math.min(x0,x);x1=Math.max(x1,x);y0=Math.min(y0,y);y1=Math.max(y1,y)};
 for(const p of map.paths)for(const q of p)see(q[0],q[1]);for(const t of map.tags)if(t.p)see(t.p[0],t.p[1]);
 if(overlay&&overlay.camera)see(overlay.camera.p[0],overlay.camera.p[1]);
 if(x0>x1){x0=y0=-1;x1=y1=1}x0-=.5;x1+=.5;y0-=.5;y1+=.5;
 const k=Math.min(W/(x1-x0),H/(y1-y0)),X=x=>W/2+k*(x-(x0+x1)/2),Y=y=>H/2-k*(y-(y0+y1)/2);
 const step=[.1,.2,.5,1,2,5,10,20,50,100].find(s=>s*k>45)||200;g.font='11px system-ui,sans-serif';
 g.strokeStyle=css('--line');g.fillStyle=css('--soft');g.lineWidth=1;g.beginPath();
 const left=(x0+x1)/2-W/2/k,low=(y0+y1)/2-H/2/k;
 for(let x=Math.ceil(left/step)*step;X(x)<W;x+=step){g.moveTo(X(x),0);g.lineTo(X(x),H);g.fillText(+x.toFixed(2),X(x)+2,H-3)}
 for(let y=Math.ceil(low/step)*step;Y(y)>0;y+=step){g.moveTo(0,Y(y));g.lineTo(W,Y(y));g.fillText(+y.toFixed(2),2,Y(y)-2)}
 g.stroke();g.strokeStyle=css('--path');g.lineWidth=2;
 for(const p of map.paths){g.beginPath();p.forEach((q,i)=>i?g.lineTo(X(q[0]),Y(q[1])):g.moveTo(X(q[0]),Y(q[1])));g.stroke()}
 const good=css('--good'),doubt=css('--doubt'),few=map.tags.length<=80;g.lineWidth=1;
 for(const t of map.tags){if(!t.p)continue;const x=X(t.p[0]),y=Y(t.p[1]);g.strokeStyle=g.fillStyle=t.status==='CONVERGED'?good:doubt;
  const[a,b,d]=t.c,m=(a+d)/2,s=Math.hypot((a-d)/2,b),q=5.991,A=k*Math.sqrt(q*(m+s)),B=k*Math.sqrt(q*Math.max(m-s,0));
  g.beginPath();g.ellipse(x,y,A,B,-Math.atan2(2*b,a-d)/2,0,7);g.stroke();g.globalAlpha=.15;g.fill();g.globalAlpha=1;
  g.beginPath();g.arc(x,y,2.5,0,7);g.fill();if(few)g.fillText(label(t.epc),x+5,y-4);
  for(const o of t.other||[]){g.beginPath();g.arc(X(o[0]),Y(o[1]),3.5,0,7);g.stroke()}}
 if(overlay&&overlay.camera){const{p,ahead}=overlay.camera,n=Math.hypot(...ahead)||1,u=ahead[0]/n,v=-ahead[1]/n,x=X(p[0]),y=Y(p[1]);
  g.fillStyle=css('--ink');g.beginPath();g.moveTo(x+12*u,y+12*v);g.lineTo(x-5*u-6*v,y-5*v+6*u);g.lineTo(x-5*u+6*v,y-5*v-6*u);g.fill()}
}
function soon(what){if(what==='map'&&!mapDue){mapDue=true;requestAnimationFrame(drawMap)}
 if(what==='picture'&&!pictureDue){pictureDue=true;requestAnimationFrame(drawPicture)}}
function cells(row,values){while(row.cells.length<values.length)row.insertCell();values.forEach((v,i)=>{if(row.cells[i].textContent!==v)row.cells[i].textContent=v})}
function showTags(){
 const body=$('tags'),shown=map.tags.slice(0,500);while(body.rows.length>shown.length)body.deleteRow(-1);
 shown.forEach((t,i)=>{const row=body.rows[i]||body.insertRow(),f=(v,k,d)=>v?v.map(x=>(x*k).toFixed(d)):['–','–','–'];
  cells(row,[t.epc,t.status,...f(t.p,1,3),...f(t.s,100,1),String(t.reads)]);row.cells[1].className=t.status;row.title=t.uri||''});
 $('count').textContent='('+map.tags.filter(t=>t.p).length+' of '+map.tags.length+' located'+(map.tags.length>500?'; 500 listed':'')+')';
}
function list(id,entries){const dl=$(id);dl.replaceChildren();for(const[k,v]of entries){const t=document.createElement('dt'),d=document.createElement('dd');t.textContent=k;d.textContent=v;dl.append(t,d)}}
function showStatus(m){
 const b=m.box,w=$('well');w.textContent=b.well?'well':b.problems.join(', ');w.className=b.well?'well':'ill';
 $('line').textContent=m.line.trim().replace(/^[^;]*; /,'');if(!b.odometry)return;const r=b.rates||{};
 list('health',[['Odometry',b.odometry.status+', '+b.odometry.inliers+' inliers'],
  ['Frames',(r.frames_hz||0).toFixed(1)+' /s'],['Reads',(r.reads_hz||0).toFixed(1)+' /s, '+b.reads+' in all, '+b.reads_rejected+' rejected'],
  ['Reader',b.reader?(b.reader.reading?'reading':'not reading')+', '+b.reader.connections+' connections':'none'],
  ['Faults',b.faults?b.faults+'; the last: '+b.last_fault:'none'],['Bus',b.bus.lost===null?'a log':b.bus.lost+' messages lost']]);
 list('scale',b.scale?[['Metres per unit',b.scale.m_per_unit.toFixed(4)],['1 σ',(100*b.scale.log_sigma).toFixed(2)+' %']]:[['Scale','not observable yet: turn, or weave']]);
}
function connect(){
 const s=new WebSocket((location.protocol==='https:'?'wss://':'ws://')+location.host+'/'+location.search,'rfmvo');s.binaryType='blob';
 s.onmessage=async e=>{
  if(typeof e.data!=='string'){try{const i=await createImageBitmap(e.data);if(image)image.close();image=i;$('nopicture').hidden=true;soon('picture')}catch(_){}return}
  const m=JSON.parse(e.data);
  if(m.type==='overlay'){overlay=m;soon('picture');soon('map')}
  if(m.type==='map'){map=m;soon('map');showTags()}
  if(m.type==='status')showStatus(m)};
 s.onclose=()=>{$('well').textContent='not connected';$('well').className='ill';setTimeout(connect,1000)};
}
addEventListener('resize',()=>{soon('map');soon('picture')});drawMap();drawPicture();connect();
</script></body></html>
)html";

}  // namespace rfmvo::view
