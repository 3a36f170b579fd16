"use strict";
/* The page of kilter. It holds parts of three:
The MIT License

Copyright (c) 2010-2026 three.js authors

Permission is hereby granted, free of charge, to any person obtaining a copy
of this software and associated documentation files (the "Software"), to deal
in the Software without restriction, including without limitation the rights
to use, copy, modify, merge, publish, distribute, sublicense, and/or sell
copies of the Software, and to permit persons to whom the Software is
furnished to do so, subject to the following conditions:

The above copyright notice and this permission notice shall be included in
all copies or substantial portions of the Software.

THE SOFTWARE IS PROVIDED "AS IS", WITHOUT WARRANTY OF ANY KIND, EXPRESS OR
IMPLIED, INCLUDING BUT NOT LIMITED TO THE WARRANTIES OF MERCHANTABILITY,
FITNESS FOR A PARTICULAR PURPOSE AND NONINFRINGEMENT. IN NO EVENT SHALL THE
AUTHORS OR COPYRIGHT HOLDERS BE LIABLE FOR ANY CLAIM, DAMAGES OR OTHER
LIABILITY, WHETHER IN AN ACTION OF CONTRACT, TORT OR OTHERWISE, ARISING FROM,
OUT OF OR IN CONNECTION WITH THE SOFTWARE OR THE USE OR OTHER DEALINGS IN
THE SOFTWARE.
It holds parts of fflate:
MIT License

Copyright (c) 2026 Arjun Barrett

Permission is hereby granted, free of charge, to any person obtaining a copy
of this software and associated documentation files (the "Software"), to deal
in the Software without restriction, including without limitation the rights
to use, copy, modify, merge, publish, distribute, sublicense, and/or sell
copies of the Software, and to permit persons to whom the Software is
furnished to do so, subject to the following conditions:

The above copyright notice and this permission notice shall be included in all
copies or substantial portions of the Software.

THE SOFTWARE IS PROVIDED "AS IS", WITHOUT WARRANTY OF ANY KIND, EXPRESS OR
IMPLIED, INCLUDING BUT NOT LIMITED TO THE WARRANTIES OF MERCHANTABILITY,
FITNESS FOR A PARTICULAR PURPOSE AND NONINFRINGEMENT. IN NO EVENT SHALL THE
AUTHORS OR COPYRIGHT HOLDERS BE LIABLE FOR ANY CLAIM, DAMAGES OR OTHER
LIABILITY, WHETHER IN AN ACTION OF CONTRACT, TORT OR OTHERWISE, ARISING FROM,
OUT OF OR IN CONNECTION WITH THE SOFTWARE OR THE USE OR OTHER DEALINGS IN THE
SOFTWARE. */
(()=>{var An=Uint8Array,ps=Uint16Array,pg=Int32Array,id=new An([0,0,0,0,0,0,0,0,1,1,1,1,2,2,2,2,3,3,3,3,4,4,4,4,5,5,5,5,0,0,0,0]),sd=new An([0,0,0,0,1,1,2,2,3,3,4,4,5,5,6,6,7,7,8,8,9,9,10,10,11,11,12,12,13,13,0,0]),mg=new An([16,17,18,0,8,7,9,6,10,5,11,4,12,3,13,2,14,1,15]),rd=function(i,t){for(var e=new ps(31),n=0;n<31;++n)e[n]=t+=1<<i[n-1];for(var s=new pg(e[30]),n=1;n<30;++n)for(var r=e[n];r<e[n+1];++r)s[r]=r-e[n]<<5|n;return{b:e,r:s}},od=rd(id,2),ad=od.b,gg=od.r;ad[28]=258,gg[258]=28;var ld=rd(sd,0),_g=ld.b,Iw=ld.r,Uc=new ps(32768);for(pe=0;pe<32768;++pe)ri=(pe&43690)>>1|(pe&21845)<<1,ri=(ri&52428)>>2|(ri&13107)<<2,ri=(ri&61680)>>4|(ri&3855)<<4,Uc[pe]=((ri&65280)>>8|(ri&255)<<8)>>1;var ri,pe,cr=(function(i,t,e){for(var n=i.length,s=0,r=new ps(t);s<n;++s)i[s]&&++r[i[s]-1];var o=new ps(t);for(s=1;s<t;++s)o[s]=o[s-1]+r[s-1]<<1;var a;if(e){a=new ps(1<<t);var l=15-t;for(s=0;s<n;++s)if(i[s])for(var c=s<<4|i[s],h=t-i[s],u=o[i[s]-1]++<<h,d=u|(1<<h)-1;u<=d;++u)a[Uc[u]>>l]=c}else for(a=new ps(n),s=0;s<n;++s)i[s]&&(a[s]=Uc[o[i[s]-1]++]>>15-i[s]);return a}),hr=new An(288);for(pe=0;pe<144;++pe)hr[pe]=8;var pe;for(pe=144;pe<256;++pe)hr[pe]=9;var pe;for(pe=256;pe<280;++pe)hr[pe]=7;var pe;for(pe=280;pe<288;++pe)hr[pe]=8;var pe,cd=new An(32);for(pe=0;pe<32;++pe)cd[pe]=5;var pe;var xg=cr(hr,9,1);var vg=cr(cd,5,1),Dc=function(i){for(var t=i[0],e=1;e<i.length;++e)i[e]>t&&(t=i[e]);return t},In=function(i,t,e){var n=t/8|0;return(i[n]|i[n+1]<<8)>>(t&7)&e},Nc=function(i,t){var e=t/8|0;return(i[e]|i[e+1]<<8|i[e+2]<<16)>>(t&7)},yg=function(i){return(i+7)/8|0},bg=function(i,t,e){return(t==null||t<0)&&(t=0),(e==null||e>i.length)&&(e=i.length),new An(i.subarray(t,e))};var Mg=["unexpected EOF","invalid block type","invalid length/literal","invalid distance","stream finished","no stream handler",,"no callback","invalid UTF-8 data","extra field too long","date not in range 1980-2099","filename too long","stream finishing","invalid zip data"],Ln=function(i,t,e){var n=new Error(t||Mg[i]);if(n.code=i,Error.captureStackTrace&&Error.captureStackTrace(n,Ln),!e)throw n;return n},Sg=function(i,t,e,n){var s=i.length,r=n?n.length:0;if(!s||t.f&&!t.l)return e||new An(0);var o=!e,a=o||t.i!=2,l=t.i;o&&(e=new An(s*3));var c=function(kt){var jt=e.length;if(kt>jt){var Qt=new An(Math.max(jt*2,kt));Qt.set(e),e=Qt}},h=t.f||0,u=t.p||0,d=t.b||0,f=t.l,m=t.d,x=t.m,p=t.n,g=s*8;do{if(!f){h=In(i,u,1);var y=In(i,u+1,3);if(u+=3,y)if(y==1)f=xg,m=vg,x=9,p=5;else if(y==2){var A=In(i,u,31)+257,_=In(i,u+10,15)+4,E=A+In(i,u+5,31)+1;u+=14;for(var O=new An(E),P=new An(19),U=0;U<_;++U)P[mg[U]]=In(i,u+U*3,7);u+=_*3;for(var G=Dc(P),$=(1<<G)-1,L=cr(P,G,1),U=0;U<E;){var V=L[In(i,u,$)];u+=V&15;var w=V>>4;if(w<16)O[U++]=w;else{var X=0,z=0;for(w==16?(z=3+In(i,u,3),u+=2,X=O[U-1]):w==17?(z=3+In(i,u,7),u+=3):w==18&&(z=11+In(i,u,127),u+=7);z--;)O[U++]=X}}var nt=O.subarray(0,A),H=O.subarray(A);x=Dc(nt),p=Dc(H),f=cr(nt,x,1),m=cr(H,p,1)}else Ln(1);else{var w=yg(u)+4,S=i[w-4]|i[w-3]<<8,T=w+S;if(T>s){l&&Ln(0);break}a&&c(d+S),e.set(i.subarray(w,T),d),t.b=d+=S,t.p=u=T*8,t.f=h;continue}if(u>g){l&&Ln(0);break}}a&&c(d+131072);for(var Q=(1<<x)-1,et=(1<<p)-1,Et=u;;Et=u){var X=f[Nc(i,u)&Q],Nt=X>>4;if(u+=X&15,u>g){l&&Ln(0);break}if(X||Ln(2),Nt<256)e[d++]=Nt;else if(Nt==256){Et=u,f=null;break}else{var Y=Nt-254;if(Nt>264){var U=Nt-257,ht=id[U];Y=In(i,u,(1<<ht)-1)+ad[U],u+=ht}var At=m[Nc(i,u)&et],Ot=At>>4;At||Ln(3),u+=At&15;var H=_g[Ot];if(Ot>3){var ht=sd[Ot];H+=Nc(i,u)&(1<<ht)-1,u+=ht}if(u>g){l&&Ln(0);break}a&&c(d+131072);var vt=d+Y;if(d<H){var Bt=r-H,ye=Math.min(H,vt);for(Bt+d<0&&Ln(3);d<ye;++d)e[d]=n[Bt+d]}for(;d<vt;++d)e[d]=e[d-H]}}t.l=f,t.p=Et,t.b=d,t.f=h,f&&(h=1,t.m=x,t.d=m,t.n=p)}while(!h);return d!=e.length&&o?bg(e,0,d):e.subarray(0,d)};var wg=new An(0);var Eg=function(i,t){return((i[0]&15)!=8||i[0]>>4>7||(i[0]<<8|i[1])%31)&&Ln(6,"invalid zlib data"),(i[1]>>5&1)==+!t&&Ln(6,"invalid zlib data: "+(i[1]&32?"need":"unexpected")+" dictionary"),(i[1]>>3&4)+2};function hd(i,t){return Sg(i.subarray(Eg(i,t&&t.dictionary),-4),{i:2},t&&t.out,t&&t.dictionary)}var Ag=typeof TextDecoder<"u"&&new TextDecoder,Tg=0;try{Ag.decode(wg,{stream:!0}),Tg=1}catch{}var Cg=/[\\|:. _-]/,Rg=/[\\|:. _-]$/;function bo(i){let t=i.map(r=>r.split("/").filter(Boolean)),e=new Map;t.forEach((r,o)=>{let a=r.length?r[r.length-1]:i[o];e.has(a)?e.get(a).push(o):e.set(a,[o])});let n=[...i];for(let[r,o]of e)o.length===1?n[o[0]]=r:Pg(o.map(a=>t[a].slice(0,-1))).forEach((a,l)=>n[o[l]]=a?`${r} (${a})`:r);let s=Lg(n);return new Set(s).size===i.length?s:i}function Pg(i){let t=Math.max(...i.map(s=>s.length)),n=Array.from({length:t},(s,r)=>i.map(o=>o[o.length-1-r]??"")).filter(s=>new Set(s).size>1).map(Ig);return i.map((s,r)=>n.map(o=>o[r]).reverse().filter(Boolean).join("/"))}function Ig(i){let t=i[0];for(let e of i)for(;!e.startsWith(t);)t=t.slice(0,-1);for(;t&&!Rg.test(t);)t=t.slice(0,-1);return i.some(e=>e.length===t.length)?i:i.map(e=>e.slice(t.length))}function Lg(i){let t=new Map,e=i.map(n=>n.includes("(")?[]:[...Dg(n)]);return e.forEach((n,s)=>[i[s],...n].forEach(r=>t.set(r,(t.get(r)||0)+1))),i.map((n,s)=>{if(n.length<=18)return n;let r=e[s].find(o=>t.get(o)===1);return r===void 0||r.length>n.length-4?n:`\u2026${r}`})}function*Dg(i){for(let t=i.length-4;t>0;t-=1)Cg.test(i[t-1])&&(yield i.slice(t))}var ud={f4:Float32Array,f8:Float64Array,u1:Uint8Array,u2:Uint16Array,u4:Uint32Array};function Ng({type:i,data:t,zlib:e}){let n=atob(e??t),s=new Uint8Array(n.length);for(let r=0;r<n.length;r+=1)s[r]=n.charCodeAt(r);return e&&(s=hd(s).slice()),new ud[i](s.buffer)}function Xn(i){return Array.isArray(i)?i.map(Xn):i===null||typeof i!="object"?i:typeof(i.zlib??i.data)=="string"&&i.type in ud?Ng(i):Object.fromEntries(Object.entries(i).map(([t,e])=>[t,Xn(e)]))}function dd(i){let t=Xn(JSON.parse(i));return t&&t.parts&&(t.parts.tails=bo(t.parts.names)),t}var b=i=>document.getElementById(i),mt=(i,t,e)=>b(i).addEventListener(t,e);function Mo(i,t){i.replaceChildren(...t.flatMap(([e,n])=>{let[s,r]=[document.createElement("dt"),document.createElement("dd")];return s.textContent=e,r.textContent=n,[s,r]}))}function So(i,t){let e=Math.max(0,Math.min(1,i))*(t.length-1),n=Math.min(t.length-2,Math.floor(e));return t[n].map((s,r)=>s+(e-n)*(t[n+1][r]-s))}var wo=i=>fd(i,"ramp"),fd=(i,t)=>i(t).split(",").map(e=>Zi(e.trim()));function qn(i){let t=getComputedStyle(i);return e=>t.getPropertyValue(`--${e}`).trim()}function Eo(i,t){let e=fd(i,"bodies");return e[t%e.length]}var Zi=i=>[1,3,5].map(t=>parseInt(i.slice(t,t+2),16));var Ug=400;function Ao(i,t){let e=document.documentElement,n=null,s=[];window.addEventListener("beforeprint",()=>{n=e.dataset.theme||"",s=[...document.querySelectorAll("details:not([open])")].filter(r=>r.querySelectorAll("tr").length<=Ug);for(let r of s)r.open=!0;e.dataset.theme="light",i.theme(),i.ball&&i.ball.paint(),t.hidden=!i.stage,i.stage&&Og(i,t)}),window.addEventListener("afterprint",()=>{n?e.dataset.theme=n:delete e.dataset.theme;for(let r of s)r.open=!1;i.theme()})}function Og({stage:i,names:t},e){let[n,s]=i.size,r=e.width/n;e.height=Math.round(s*r);let o=document.createElement("canvas");Object.assign(o,{width:e.width,height:e.height}),i.shootInto(o,i.camera,r);let a=qn(document.documentElement),l=e.getContext("2d");l.drawImage(o,0,0),l.font=`600 ${13*r}px system-ui, sans-serif`,l.textAlign="center",l.textBaseline="middle",l.lineJoin="round",l.lineWidth=4*r,l.strokeStyle=a("surface"),l.fillStyle=a("ink");for(let[c,{element:h,off:u}]of t.tags){let d=u&&i.onScreen(i.parts.centre(c));if(!d)continue;let f=[0,1].map(m=>(d[m]+u[m])*r);l.strokeText(h.textContent,...f),l.fillText(h.textContent,...f)}}function To(i,t){let e=-1,n=-1/0;for(let s=0;s<i.length;s+=3){let r=i[s]*t[0]+i[s+1]*t[1]+i[s+2]*t[2];r>n&&(n=r,e=s/3)}return[e,n]}function Co(i){let t=0;for(let e=0;e<i.vertices.length;e+=3)t=Math.max(t,Math.hypot(...i.vertices.subarray(e,e+3)));return t/i.mass}function Ro(i,t,e=1e-4){let n=t.map((o,a)=>ur(i,a,o)),s=n.reduce((o,a)=>Math.max(o,a),0),r=[];return n.forEach((o,a)=>{s>0&&o>e*s&&r.push(a)}),r}function ur(i,t,e){let n=i.subarray(6*t,6*t+6);return Math.max(Math.hypot(n[0],n[1],n[2]),e*Math.hypot(n[3],n[4],n[5]))}var Lt=(i,t)=>i[0]*t[0]+i[1]*t[1]+i[2]*t[2],Xt=(i,t)=>[i[0]+t[0],i[1]+t[1],i[2]+t[2]],Ct=(i,t)=>[i[0]*t,i[1]*t,i[2]*t],ce=(i,t)=>[i[1]*t[2]-i[2]*t[1],i[2]*t[0]-i[0]*t[2],i[0]*t[1]-i[1]*t[0]],Ht=i=>Math.hypot(i[0],i[1],i[2]);function me(i){let t=Ht(i);return t>0?Ct(i,1/t):[0,0,0]}function Be(i,t){return Math.atan2(Ht(ce(i,t)),Lt(i,t))}var Dn=(i,t)=>Xt(i,Ct(t,-Lt(i,t)));function Po(i,t,e){let n=Math.cos(e),s=Math.sin(e),r=Ct(t,Lt(t,i)*(1-n));return Xt(Xt(Ct(i,n),Ct(ce(t,i),s)),r)}function Io(i){let t=[0,1,2].reduce((n,s)=>Math.abs(i[s])<Math.abs(i[n])?s:n,0),e=[0,0,0];return e[t]=1,me(ce(i,e))}function Ji(i,t,e){let n=Math.hypot(i,t,e);if(n===0)return[0,0,0,1];let s=Math.sin(n/2)/n;return[i*s,t*s,e*s,Math.cos(n/2)]}function pd(i,t){return[i[3]*t[0]+i[0]*t[3]+i[1]*t[2]-i[2]*t[1],i[3]*t[1]-i[0]*t[2]+i[1]*t[3]+i[2]*t[0],i[3]*t[2]+i[0]*t[1]-i[1]*t[0]+i[2]*t[3],i[3]*t[3]-i[0]*t[0]-i[1]*t[1]-i[2]*t[2]]}function oi(i,t){let[e,n,s,r]=i,o=2*(n*t[2]-s*t[1]),a=2*(s*t[0]-e*t[2]),l=2*(e*t[1]-n*t[0]);return[t[0]+r*o+n*l-s*a,t[1]+r*a+s*o-e*l,t[2]+r*l+e*a-n*o]}function Lo(i,t,e){let n=0;for(let s=0;s<t.length;s+=1)n=Math.max(n,ur(i,s,t[s]));return n>0?e/n:0}function Fg(i,t,e){let n=e*Ht(t),[s,r]=n>1e-4?[(1-Math.cos(n))/n**2,(n-Math.sin(n))/n**3]:[1/2,1/6],o=ce(t,i),a=ce(t,o);return i.map((l,c)=>e*l+s*e**2*o[c]+r*e**3*a[c])}function Do(i,t,e,n,s){let r=i.position.subarray(3*t,3*t+3),o=i.center.subarray(3*t,3*t+3),[a,l,c,h]=i.rotation.subarray(4*t,4*t+4),u=[l,c,h,a],d=[0,1,2].map(f=>r[f]+s*o[f]);if(e&&n){let f=e.subarray(6*t,6*t+6);if(f[3]||f[4]||f[5]){let x=Ji(n*f[3],n*f[4],n*f[5]),p=[r[0]-o[0],r[1]-o[1],r[2]-o[2]],g=oi(x,p);u=pd(x,u);for(let y=0;y<3;y+=1)d[y]+=g[y]-p[y]}let m=Fg([...f.subarray(0,3)],[...f.subarray(3,6)],n);for(let x=0;x<3;x+=1)d[x]+=m[x]}return[u,d]}function md(i,t,e,n){let s=i.position.subarray(3*t,3*t+3),[r,o,a,l]=i.rotation.subarray(4*t,4*t+4),c=[o,a,l,r],h=[...s];if(n){let u=i.center.subarray(3*t,3*t+3),d=oi(n,[0,1,2].map(f=>s[f]-u[f]));c=pd(n,c),h=d.map((f,m)=>f+u[m])}return e&&(h=h.map((u,d)=>u+e[d])),[c,h]}function dr(i,t,e){let[n,s,r,o]=i.rotation.subarray(4*t,4*t+4),a=i.position.subarray(3*t,3*t+3);return oi([-s,-r,-o,n],[e[0]-a[0],e[1]-a[1],e[2]-a[2]])}var Bg=(i,t)=>i.equations.every(e=>Math.abs(Lt(e,t))<=i.blur);function Ti(i,t){let e=me(t);return Ht(e)===0||i.dimension===0?!1:Bg(i,e)&&i.facets.every(n=>Lt(n,e)>=-i.blur)}function _d(i,t){let e=me(t);if(!i.facets.length)return Math.PI;let n=Math.min(...i.facets.map(s=>Lt(s,e)));return Math.asin(Math.min(1,Math.max(0,n)))}var Ci=(i,t)=>i.dimension<(t?2:3);function Fc(i,t){if(i.dimension===0)return null;let e=me(t),n=i.equations.reduce((l,c)=>Dn(l,c),e),s=[n,...i.facets.map(l=>Dn(n,l))],r=i.lines.reduce((l,c)=>Xt(l,Ct(c,Lt(c,e))),[0,0,0]);for(let l of i.rays)s.push(Xt(r,Ct(l,Math.max(0,Lt(l,e)))));let o=s.filter(l=>Ht(l)>1e-12&&Ti(i,l));return o.length?me(o.reduce((l,c)=>Ht(c)>Ht(l)?c:l)):[...i.rays,...i.lines,...i.lines.map(l=>Ct(l,-1))].reduce((l,c)=>Lt(c,e)>Lt(l,e)?c:l)}function No(i,t){if(Ti(i,t))return 0;let e=Fc(i,t);return e&&Be(e,t)}function xd(i){let[t,e]=i.lines,[n,s]=i.rays;switch(i.kind){case"ray":return[Oc(n)];case"line":return[Oc(t),Oc(Ct(t,-1))];case"fan":return[gd(n,s)];case"half-plane":return[{u:t,v:n,angle:Math.PI}];case"plane":return[{u:t,v:e,angle:2*Math.PI}];case"cone":return i.rays.map((r,o)=>gd(r,i.rays[(o+1)%i.rays.length]));case"wedge":return[{u:t,v:n,angle:Math.PI},{u:Ct(t,-1),v:s,angle:Math.PI}];case"half-space":return[{u:t,v:e,angle:2*Math.PI}];default:return[]}}var Oc=i=>({u:i,v:Io(i),angle:0});function gd(i,t){let e=me(Dn(t,i));return{u:i,v:Ht(e)?e:Io(i),angle:Be(i,t)}}var vd=(i,t)=>Xt(Ct(i.u,Math.cos(t)),Ct(i.v,Math.sin(t)));function yd(i){return i.flatMap(t=>{let e=Io(t),n=ce(t,e),[s,r]=[0,Math.PI];for(let a of i){let[l,c]=[Lt(a,e),Lt(a,n)];if(a===t||Math.hypot(l,c)<1e-12)continue;let h=Math.atan2(c,l);if(r===Math.PI)[s,r]=[h,Math.PI/2];else{let u=Math.atan2(Math.sin(h-s),Math.cos(h-s)),[d,f]=[Math.max(-r,u-Math.PI/2),Math.min(r,u+Math.PI/2)];[s,r]=[s+(d+f)/2,(f-d)/2]}if(r<=0)return[]}let o=a=>Xt(Ct(e,Math.cos(a)),Ct(n,Math.sin(a)));return[{u:o(s-r),v:o(s-r+Math.PI/2),angle:2*r}]})}function bd(i,t){let e=me(t),n=(r,o)=>{let a=r.reduce((c,h,u)=>Xt(c,Ct(i[h],o[u])),[0,0,0]),l=Ht(Xt(a,Ct(e,-1)));return o.every(c=>c>=-1e-9)&&l<1e-7?r.map((c,h)=>[c,Math.max(0,o[h])]):null},s=i.length;for(let r=0;r<s;r+=1){let o=n([r],[Lt(i[r],e)]);if(o)return o}for(let r=0;r<s;r+=1)for(let o=r+1;o<s;o+=1){let a=Lt(i[r],i[o]),l=1-a*a;if(l<1e-12)continue;let[c,h]=[Lt(i[r],e),Lt(i[o],e)],u=n([r,o],[(c-a*h)/l,(h-a*c)/l]);if(u)return u}for(let r=0;r<s;r+=1)for(let o=r+1;o<s;o+=1){let a=ce(i[r],i[o]);for(let l=o+1;l<s;l+=1){let c=Lt(a,i[l]);if(Math.abs(c)<1e-9)continue;let h=Lt(ce(i[o],i[l]),e)/c,u=Lt(ce(i[l],i[r]),e)/c,d=n([r,o,l],[h,u,Lt(a,e)/c]);if(d)return d}}return null}var kg=500,zg=1e-9;function ai(i){let t=i*180/Math.PI;return`${Math.abs(t)<zg?"0":t<.01?ve(t,2):t<10?t.toFixed(2):t.toFixed(1)}\xB0`}var Md=i=>`undecided: neither is proved; at most ${ve(i,2)}\xB0 wide`,ve=(i,t=4)=>Number.isFinite(i)?String(Number(Number(i).toPrecision(t))):"\u2013";function ln(i){let t=[[1e6,"MN"],[1e3,"kN"],[1,"N"],[.001,"mN"]],[e,n]=t.find(([s])=>Math.abs(i)>=s)||[1,"N"];return`${ve(i/e)} ${n}`}function Bc(i){let t=[[1e6,"MJ"],[1e3,"kJ"],[1,"J"],[.001,"mJ"],[1e-6,"\xB5J"]],[e,n]=t.find(([s])=>Math.abs(i)>=s)||[1,"J"];return`${ve(i/e,3)} ${n}`}function Sd(i){let t=i?[...i].filter(s=>s>0):[],[e,n]=t.reduce(([s,r],o)=>[Math.min(s,o),Math.max(r,o)],[1/0,0]);return t.length?e===n?`${ln(e)} per point`:`${ln(e)} to ${ln(n)} per point`:""}var Nn=(i,t=4)=>`(${i.map(e=>Math.abs(e)<5e-7?0:Number(e.toFixed(t))).join(", ")})`.replaceAll("-","\u2212");function kc(i,t){let{region:e}=i;return e?e.kind==="none"?e.words.none:t.margin===null||t.margin===void 0?t.away===void 0||t.away===null?"":t.away?`${ai(t.away)} away from the nearest ${e.words.nearest}`:"on the boundary of the region in which holding is proved":!e.facets.length&&!e.equations.length?"the parts hold for every direction of gravity":Ci(e,i.planar)?e.dimension<2?"margin 0\xB0: no tilt is allowed (a knife edge)":`margin ${e.facets.length?ai(t.within):"unlimited"} within the ${e.kind}, 0\xB0 out of it (a knife edge)`:e.facets.length?`margin ${ai(t.margin)}: the tilt that is allowed in every direction`:"the parts hold for every direction of gravity in the plane":i.left_out?"":"the stable region of this assembly was not computed"}function wd(i,t,e=0,n=8){let s=i.parts.grounded.filter(u=>!u).length;if(t.moving===null||t.moving===void 0)return t.verdict==="unknown"?"":"the moving parts are not known for this direction";if(!t.moving.length)return t.verdict==="undecided"?"":"no part moves";let r=t.moving.slice(0,n).map(u=>Ri(i.parts.tails[u])),o=t.moving.length>n?` and ${t.moving.length-n} more`:"",l=i.region&&i.region.friction&&t.from==="cone"||t.verdict==="undecided"?"with the frictionless contacts alone, ":"",c=`${t.moving.length} of ${s} free ${s===1?"part moves":"parts move"}`,h=e?` (${e===t.moving.length?"hidden":`${e} of them hidden`} in the picture)`:"";return`${l}${c}: ${r.join(", ")}${o}${h}`}var Ri=(i,t=40)=>`\u2068${i.length>t?`${i.slice(0,t-1)}\u2026`:i}\u2069`;function Ed(i,t){let{region:e}=i;if(t.from==="given")return`Full analysis of gravity as given${i.coincide?", which is also the recommended direction":""}.`;if(t.from==="recommended")return"Full analysis of the recommended direction.";if(!e)return"Only the given direction was analysed.";let n=e.words.basis;return t.motion?`${n} Motion: solution of the displacement program without friction, from the stability map.`:t.forces?`${n} Forces: the forces of the cone's rays, combined with the same weights as the direction.`:n}function ji(i,t){let{names:e,tails:n}=i.parts;if(e.length>kg)return t;let s=e.map((r,o)=>[r,n[o]]).filter(([r,o])=>r.includes("/")&&r!==o);return s.sort(([r],[o])=>o.length-r.length),s.reduce((r,[o,a])=>r.replaceAll(o,a),t)}function Ad(i,t){let e=i.replace(`${t}: `,"");return e.charAt(0).toUpperCase()+e.slice(1)}var Td=360,Cd=112,li={left:8,right:8,top:20,bottom:20},Gg={open:"The drawing shows the fall without friction.",holds:"The drawing shows how the parts would slide without friction.",falls:"The drawing shows the parts sliding without friction; with friction they roll."};function Vg(i,t){let e=i.length-1,n=Math.max(0,Math.min(1,t))*i[e],s=1;for(;s<e&&i[s]<n;)s+=1;let r=i[s]-i[s-1];return[s,r>0?(n-i[s-1])/r:1,n]}function zc(i,t){let{motions:e,energies:n,lengths:s}=i.places,[r,o,a]=Vg(s,t),l=6*i.parts.length,c=u=>e[l*(r-1)+u]*(1-o)+e[l*r+u]*o,h=u=>[c(u),c(u+1),c(u+2)];return{length:a,energy:n[r-1]*(1-o)+n[r]*o,shifts:i.parts.map((u,d)=>h(6*d)),turns:i.parts.map((u,d)=>Ji(...h(6*d+3)))}}function fr(i,{center:t,radius:e},n,s){let r=(o,a,l)=>{let c=Math.min(e[o],Math.max(0,n[a]-Math.abs(t[3*o+a])));return Math.abs(t[3*o+a]+l)+c-n[a]};return[0,1,2].map(o=>Math.max(0,...i.map((a,l)=>r(a,o,s[l][o]))))}var Gc=(i,{length:t,energy:e})=>`${ve(t,3)} ${i} along the path, energy ${Bc(e).replace("-","\u2212")}`,Rd=i=>Gg[i.friction];function Hg({energies:i,lengths:t}){let e=t.length-1,n=i[e],[s,r]=[Td-li.left-li.right,Cd-li.top-li.bottom],o=(a,l)=>[li.left+s*a/t[e],li.top+r*l/n];return{place:o,points:Array.from(t,(a,l)=>o(a,i[l]))}}var Uo=class{constructor(t,e,n){let{energies:s,lengths:r}=e.places,o=r.length-1,{place:a,points:l}=Hg(e.places),c=(x,p)=>t.querySelector(x).setAttribute("d",p),h=(x,p)=>{t.querySelector(x).textContent=p},u={length:r[o],energy:s[o]},{left:d,top:f}=li,m=l.map(x=>x.map(p=>p.toFixed(2)).join(" ")).join("L");this.place=a,this.mark=t.querySelector(".mark"),t.setAttribute("aria-label",`Energy during the fall; at the end: ${Gc(n,u)}`),c(".axis",`M${d} ${Cd-li.bottom}V${f}H${Td-li.right}`),c(".under",`M${m}V${f}H${d}Z`),c(".energy",`M${m}`),h(".far",`${ve(u.length,3)} ${n} along the path`),h(".least",Bc(u.energy).replace("-","\u2212"))}show({length:t,energy:e}){let[n,s]=this.place(t,e);this.mark.setAttribute("cx",n),this.mark.setAttribute("cy",s)}};var Wg=1e-6;function Vc(i,{points:t,parts:e,forces:n,patch:s,pull:r=null,use:o=null},a=!1){let{normals:l,normal:c,mu:h}=i.patches,u=new Set(s&&r?[...s].filter((x,p)=>r[p]>0):[]),d=a||!s,f=new Map,m=(x,p)=>[x[3*p],x[3*p+1],x[3*p+2]];for(let x=0;x<t.length/3;x+=1){let p=s?s[x]:-1,g=d?x:p;f.has(g)||f.set(g,qg([e[2*x],e[2*x+1]],d?0:h[p]));let y=f.get(g),w=m(n,x),S=s?l?m(l,x):m(c,p):null,T=S?Lt(w,S):Ht(w),A=u.has(p)?r[x]:0,_=d?Ht(w):u.has(p)?Math.abs(T):T;y.force=Xt(y.force,w),o&&!d&&(y.needed=o[x]),S&&(y.across=Xt(y.across,Xt(w,Ct(S,-T)))),y.moment=Xt(y.moment,Ct(m(t,x),_)),y.size+=_,y.pressed+=T+A,A>0&&(y.bond=Math.max(y.bond||0,-T/A))}return[...f.values()].filter(x=>x.size>0).map(({parts:x,force:p,across:g,size:y,moment:w,mu:S,pressed:T,bond:A,needed:_})=>({parts:x,force:p,at:Ct(w,1/y),use:Xg(S>0&&T>0?_??Ht(g)/(S*T):NaN),bond:A}))}var Xg=i=>Number.isNaN(i)?null:i,qg=(i,t)=>({parts:i,mu:t,force:[0,0,0],across:[0,0,0],moment:[0,0,0],size:0,pressed:0,needed:null,bond:null});function Pd(i,t){let e=new Map,n=t.reduce((r,{force:o})=>Math.max(r,Ht(o)),0);for(let r of t)if(!(Ht(r.force)<Wg*n||Number.isFinite(r.bond)))for(let o of r.parts)i.parts.grounded[o]||(e.has(o)||e.set(o,[]),e.get(o).push(r));let s=[];for(let[r,o]of e){if(o.length===2){s.push({part:r,from:o[0].at,to:o[1].at});continue}let{center:a}=i.parts,l=o.length===1?[0,1,2].map(c=>a[3*r+c]):$g(o);for(let{at:c}of o)s.push({part:r,from:l,to:c})}return s}function $g(i){let t=i.reduce((e,{force:n})=>e+Ht(n),0);return i.reduce((e,{at:n,force:s})=>Xt(e,Ct(n,Ht(s)/t)),[0,0,0])}var Yg=6e3;function Oo(i,t,e,n){let s={straight:[],round:[]},{radius:r}=i.page.parts,o=Lo(t,r,n);for(let a of e){let l=t.subarray(6*a,6*a+6),c=i.parts.centre(a);if(!i.parts.seen(a,c))continue;let h=o*Math.hypot(l[0],l[1],l[2]),u=o*r[a]*Math.hypot(l[3],l[4],l[5]),d=.02*n;if(h>d){let f=Math.max(h,.3*n);s.straight.push({at:c,along:l.subarray(0,3),size:f,wide:Math.max(f,.6*n)})}u>d&&s.round.push({at:c,along:l.subarray(3,6),size:.45*r[a]})}return s}function Fo(i,t,e,n=!1){let s=Vc(i.page,t,n),r=s.map(h=>Ht(h.force)),o=r.reduce((h,u)=>Math.max(h,u),0),a=r.map((h,u)=>u).filter(h=>r[h]>1e-9*o);a.sort((h,u)=>r[u]-r[h]);let[l,c]=[[],[]];for(let h of a.slice(0,Yg)){let{at:u,parts:d,force:f,use:m,bond:x}=s[h];for(let[p,g]of[[d[1],1],[d[0],-1]]){let y=i.parts.placeOf(p,u);if(!i.parts.seen(p,y))continue;let w=e*r[h]/o,S=Ct(f,g);l.push({at:y,along:S,size:w,wide:Math.max(.8*w,.15*e),tint:Math.max(m||0,x||0)}),c.push({part:p,other:d[g>0?0:1],force:S,at:y,use:m,bond:x});break}}return{straight:l,most:o,shown:c,all:s}}function Id(i,t,e){let n=[];for(let{part:s,from:r,to:o}of Pd(i.page,t)){let[a,l]=[i.parts.placeOf(s,r),i.parts.placeOf(s,o)],c=l.map((u,d)=>u-a[d]),h=Ht(c);h>0&&i.parts.seen(s,a)&&i.parts.seen(s,l)&&n.push({at:a,along:c,size:h,wide:.35*e,tint:0})}return n}function Ld(i){let{at:t,parts:e}=i.page.open,n=.03*i.page.radius,s=[];for(let r=0;r<e.length/2;r+=1){let[o,a]=e.subarray(2*r,2*r+2);if(i.page.open.decides&&!i.page.open.decides[r])continue;let l=i.parts.placeOf(a,t.subarray(3*r,3*r+3));!i.parts.seen(o,l)&&!i.parts.seen(a,l)||s.push({at:l,along:[0,1,0],size:n})}return{ball:s}}function Dd({straps:i=[],radius:t}){return{rod:i.flatMap(n=>n.slice(1).map((s,r)=>{let o=s.map((a,l)=>a-n[r][l]);return{at:n[r],along:o,size:Ht(o),wide:.1*t}})).filter(({size:n})=>n>0)}}function Nd(i,t){if(!t||!t.pull)return null;let e=new Float32Array(i.parts.names.length);for(let{parts:n,bond:s}of Vc(i,t))for(let r of n)e[r]=Math.max(e[r],s||0);return e}function Hc(i,t){let e=Math.max(0,Math.min(i.length-1,Math.floor(t)));return[e,Math.max(0,Math.min(1,t-e))]}var Wc=i=>i.slice(1).map((t,e)=>Math.hypot(...t.map((n,s)=>n-i[e][s])));function Ud(i,t){let e=Wc(i)[0];if(!(e>t))return i;let n=t/e;return[i[1].map((s,r)=>s+n*(i[0][r]-s)),...i.slice(1)]}var Od=i=>Wc(i).reduce((t,e)=>t+e,0);function Zg(i,t){let e=Wc(i);for(let n=e.length-1;n>=0;n-=1){if(t<=e[n]||n===0){let s=e[n]?Math.min(1,t/e[n]):0,[r,o]=[i[n],i[n+1]];return{place:o.map((a,l)=>a+s*(r[l]-a)),heading:o.map((a,l)=>(a-r[l])/(e[n]||1)),ahead:s*e[n]}}t-=e[n]}return{place:[0,0,0],heading:[0,0,0],ahead:0}}var Fd=i=>i*i*(3-2*i);function Xc(i,t,e){let{steps:n,base:s}=i,[r,o]=Hc(n,t),a=n[r],l=new Set(s);n.slice(0,r).forEach(({parts:u})=>u.forEach(d=>l.add(d)));let c=Ud(a.path,e),h=Od(c)*(1-Fd(Math.min(1,o/.82)));return o>0&&a.parts.forEach(u=>l.add(u)),{step:r,done:o,present:l,moving:o>0&&o<1?a.parts:[],gripped:o<1?a.held:[],on:o>0?Zg(c,h):null,turn:a.over===null?0:Jg(a,h)}}function Jg(i,t){let e=i.thread||0;return e?-2*Math.PI*3*Math.min(1,t/e):0}function Bd(i,t,e,n){let s=Ud(i.steps[t].path,n),r=Od(s),o=Math.min(.9*r,1.2*e),[a,l]=[0,1];for(let c=0;c<30;c+=1){let h=(a+l)/2;r*(1-Fd(h))>o?a=h:l=h}return t+.82*l}var jg=1.9,ms=class{constructor(t,e){Object.assign(this,{look:t,plan:e,now:null}),this.count=e.steps.length,this.reach=jg*t.page.radius}overhang(){let{parts:t,extent:e}=this.look.page,n=this.plan.steps.map((s,r)=>{let{place:o}=Xc(this.plan,this.pictureAt(r),this.reach).on;return fr(s.parts,t,e,s.parts.map(()=>o))});return[0,1,2].map(s=>Math.max(0,...n.map(r=>r[s])))}pictureAt(t){let{parts:e}=this.look.page,n=Math.max(...this.plan.steps[t].parts.map(s=>e.radius[s]));return Bd(this.plan,t,n,this.reach)}stepAt(t){return Hc(this.plan.steps,t)}jumped(t,e){let[n]=this.stepAt(t),s=this.pictureAt(n);return e>0&&t<s-1e-6?s:e>0&&n+1===this.count?this.count:e<0&&t>s+1e-6?s:this.pictureAt(Math.max(0,n+e))}place(t,e=0){let{parts:n}=this.look.stage,{plan:s}=this,r=this.spread(e),o=[];n.moving.fill(0),n.gripped.fill(0),n.present.fill(1);for(let{part:a}of s.falls)n.moving[a]=1;if(this.count){let a=Xc(s,t,this.reach),{direction:l}=s.steps[a.step];for(let c=0;c<n.count;c+=1)n.present[c]=a.present.has(c)?1:0;for(let c of a.gripped)n.gripped[c]=1;for(let c of a.moving)n.moving[c]=1;if(a.on)for(let c of s.steps[a.step].parts)r[c]=a.on.place.map((h,u)=>h+r[c][u]),a.turn&&(o[c]=Ji(...l.map(h=>h*a.turn)));this.now=a}n.carry(r,o),n.states()}spread(t){let{explode:e}=this.plan;return Array.from({length:this.look.page.parts.radius.length},(n,s)=>[0,1,2].map(r=>t*e[3*s+r]))}arrows(t,e=!1){let{stage:n,page:s}=this.look,[r,o]=this.count?this.stepAt(t):[0,1],a=this.plan.steps[r],l=this.count&&o<1;n.motion.set(this.motions(l&&a,e));let c=.5*s.radius*Number(b("force-size").value),h=!e&&l&&b("show-forces").checked&&a.support;e||(b("size-row").hidden=!h);let u=0;if(h&&h.points.length){let d=Fo(n,h,c);u=d.most,n.forces.set({straight:d.straight})}else n.forces.set({});return n.hands.set(h?this.handArrows(a,c,u):{}),u}motions(t,e){let{stage:n,page:s,long:r}=this.look,o=t?t.hands.filter(c=>c.motion).slice(0,1):this.plan.falls;if(!e&&b("show-motion").checked&&o.length){let c=o.map(h=>Oo(n,h.motion,h.moves,.6*r));return{straight:c.flatMap(h=>h.straight),round:c.flatMap(h=>h.round)}}let{on:a}=this.now||{};return!t||!a||!(a.ahead>0)?{}:{straight:t.parts.map(c=>{let h=Math.max(1.3*s.parts.radius[c],.3*r),u=Math.min(a.ahead,2.6*h);return{at:n.parts.centre(c),along:a.heading,size:u,wide:Math.min(h,2.5*u)}})}}handArrows(t,e,n){return{straight:t.hands.filter(r=>r.force&&Math.hypot(...r.force)>0).map(r=>{let o=n?Math.hypot(...r.force)/n:1,a=e*Math.max(.12,Math.min(2,o));return{at:this.look.stage.parts.centre(r.part),along:r.force,size:a,wide:Math.max(.8*a,.3*e)}})}}paint(t,e){let{stage:n}=this.look,s=this.pictureAt(t),r=[n.parts.patches,n.parts.edges].map(a=>a.visible),{selected:o}=n.parts;n.parts.selected=new Set,n.parts.patches.visible=!1,n.parts.edges.visible=!0,this.place(s),this.arrows(s,!0),n.drawLines([]),n.loads.set({}),n.open.set({}),n.snap(e),n.parts.selected=o,[n.parts.patches.visible,n.parts.edges.visible]=r}};var gs=12;function kd(i,t,e){let{parts:n,units:s,center:r}=i,o=[0,1,2].map(d=>n.center[3*e+d]+r[d]),a=!!(t.moving&&t.moving.includes(e)),l=a?"moves":t.moving?"stays":"unknown",c=Kg(i.patches.parts,e),h=c.slice(0,gs).map(d=>Ri(n.tails[d]));c.length>gs&&h.push(`${c.length-gs} more`);let u=[["mass",`${ve(n.mass[e],6)} kg`],["volume",`${ve(n.volume[e],6)} ${s}\xB3`],...qc(n,e),["centre",`${Nn(o)} ${s}`],["touches",h.join(", ")||"nothing"],["state",n.grounded[e]?"held":l]];if(a&&t.words)u.push(["motion",t.words[e]]);else if(a&&t.motion){let d=t.motion.subarray(6*e,6*e+6);u.push(["dr",`${Nn([...d.subarray(0,3)])} ${s}`]),u.push(["d\u03B8",`${Nn([...d.subarray(3,6)])} rad`])}return t.forces&&u.push(["contact forces",`${ln(Qg(t.forces,e))} in total`]),u}function qc(i,t){return["material","layer"].filter(e=>i[e]?.[t]).map(e=>[e,i[e][t]])}function Kg(i,t){let e=new Set;for(let n=0;n<i.length;n+=2)i[n]===t&&e.add(i[n+1]),i[n+1]===t&&e.add(i[n]);return[...e]}function Qg({parts:i,forces:t},e){let n=0;for(let s=0;s<i.length/2;s+=1)(i[2*s]===e||i[2*s+1]===e)&&(n+=Math.hypot(t[3*s],t[3*s+1],t[3*s+2]));return n}function zd(i,t){let{parts:e,patches:n}=i,s=t.slice(0,gs).map(l=>Ri(e.tails[l]));t.length>gs&&s.push(`${t.length-gs} more`);let r=t.reduce((l,c)=>l+e.mass[c],0),o=t.filter(l=>e.grounded[l]).length,a=[["parts",s.join(", ")],["mass",`${ve(r,6)} kg in total`],["held",o?`${o} of ${t.length}`:"none"]];if(t.length===2){let l=[...Array(n.parts.length/2).keys()].filter(h=>t.includes(n.parts[2*h])&&t.includes(n.parts[2*h+1])),c=[...new Set(l.map(h=>ve(n.mu[h])))];a.push(["contact",l.length?`${l.length} patch${l.length>1?"es":""}, friction ${c.join(", ")}`:"none"])}return a}async function Pi(i,t=null){let e=await t0(i)||e0(i);if(!t)return e;let n=t.dataset.label??=t.textContent;return t.textContent=e?"Copied":"Copying is not allowed here",clearTimeout(t.copied),t.copied=setTimeout(()=>t.textContent=n,1500),e}async function t0(i){try{return await navigator.clipboard.writeText(i),!0}catch{return!1}}function e0(i){let t=document.createElement("textarea");t.value=i,t.setAttribute("readonly",""),t.className="offscreen",document.body.append(t);let e=document.activeElement;t.select();let n=document.execCommand("copy");return t.remove(),e&&e.focus({preventScroll:!0}),n}var pr={front:[0,-1,0],back:[0,1,0],left:[-1,0,0],right:[1,0,0],top:[0,0,1],bottom:[0,0,-1],isometric:[1,-1,1]},$c=Object.fromEntries(Object.keys(pr).map((i,t)=>[String(t+1),i])),n0=[["front",[1,0,0]],["back",[-1,0,0]],["left",[0,-1,0]],["right",[0,1,0]],["top",[1,0,0]],["bottom",[1,0,0]]],Gd=[-1,-.58,.58,1],Vd=25,i0=.02,s0=.3;function r0(){return n0.flatMap(([i,t])=>{let e=pr[i],n=ce(e,t),s=(r,o)=>Xt(e,Xt(Ct(t,r),Ct(n,o)));return[0,1,2].flatMap(r=>[0,1,2].map(o=>({name:i,normal:e,along:t,up:n,toward:s(r-1,o-1),middle:r===1&&o===1,corners:[[r,o],[r+1,o],[r+1,o+1],[r,o+1]].map(([a,l])=>s(Gd[a],Gd[l]))})))})}var Bo=class{constructor(t,e,n){let s=r=>document.createElementNS(t.namespaceURI,r);this.cells=r0().map(r=>{let o=s("polygon");return o.classList.toggle("rim",!r.middle),o.addEventListener("click",()=>n(r.toward)),{...r,polygon:o}}),this.labels=this.cells.filter(r=>r.middle).map(r=>{let o=s("text");return o.textContent=r.name.charAt(0).toUpperCase()+r.name.slice(1),{...r,text:o,outline:s("path")}}),t.replaceChildren(...this.cells.map(({polygon:r})=>r)),t.append(...this.labels.flatMap(({outline:r,text:o})=>[r,o])),this.axes=["x","y","z"].map(r=>{let o=s("text");return o.textContent=r,{text:o,path:s("path")}}),e.replaceChildren(...this.axes.flatMap(({path:r,text:o})=>[r,o]))}paint(t){let e=o=>[0,1,2].map(a=>o[0]*t[0][a]+o[1]*t[1][a]+o[2]*t[2][a]),n=o=>{let[a,l]=e(o);return[Vd*a,-Vd*l]},s=new Map(this.labels.map(({name:o,normal:a})=>[o,e(a)[2]>i0])),r=(o,a)=>o.setAttribute("display",a?"inline":"none");for(let{name:o,corners:a,polygon:l}of this.cells)r(l,s.get(o)),s.get(o)&&l.setAttribute("points",a.map(c=>n(c).join()).join(" "));for(let{name:o,normal:a,along:l,up:c,text:h,outline:u}of this.labels){if(r(u,s.get(o)),r(h,e(a)[2]>s0),!s.get(o))continue;let d=(p,g)=>n(Xt(a,Xt(Ct(l,p),Ct(c,g)))).join(" ");u.setAttribute("d",`M${d(-1,-1)}L${d(1,-1)}L${d(1,1)}L${d(-1,1)}Z`);let[f,m,x]=[e(l),e(c),n(a)];h.setAttribute("transform",`matrix(${[f[0],-f[1],-m[0],m[1],...x].map(p=>p.toFixed(4)).join()})`)}this.axes.forEach(({path:o,text:a},l)=>{let[c,h,u]=t[l];o.setAttribute("d",`M0 0L${26*c} ${-26*h}`),a.setAttribute("x",33*c),a.setAttribute("y",-33*h);for(let d of[o,a])d.setAttribute("opacity",u<-.3?.45:1)})}};var Hd=(i,t)=>[i[3*t],i[3*t+1],i[3*t+2]],ko=(i,t)=>[i[0]-t[0],i[1]-t[1],i[2]-t[2]];function Wd(i,t,e,n=()=>!0){let{positions:s,triangles:r}=i,o=null;for(let a=0;a<r.length;a+=3){let[l,c,h]=[0,1,2].map(T=>Hd(s,r[a+T])),[u,d]=[ko(c,l),ko(h,l)],f=ce(e,d),m=Lt(u,f);if(Math.abs(m)<1e-300)continue;let x=ko(t,l),p=Lt(x,f)/m;if(p<0||p>1)continue;let g=ce(x,u),y=Lt(e,g)/m;if(y<0||p+y>1)continue;let w=Lt(d,g)/m;if(w<=0||o&&w>=o.far)continue;let S=Xt(t,Ct(e,w));n(S)&&(o={point:S,normal:me(ce(u,d)),far:w})}return o}function Xd(i){let t=new Set,e=[];for(let n of i.edges){let s=Hd(i.positions,n),r=s.join();t.has(r)||e.push(s),t.add(r)}return e}function qd(i,t){let e=ko(t.at,i.at),n=o0*Math.max(...i.at.map(Math.abs),...t.at.map(Math.abs)),s=l=>Math.abs(l)<n?0:l,r=e.map(s),o={distance:Ht(r),step:r,angle:null,between:null};if(!i.normal||!t.normal)return o;let a=Ht(ce(i.normal,t.normal));return o.angle=Math.atan2(a,Math.abs(Lt(i.normal,t.normal))),a<a0&&(o.between=Math.abs(s(Lt(e,i.normal)))),o}var o0=1e-6,a0=1e-4;var l0=9,zo=class{constructor(t){this.look=t,this.ends=[],this.on=!1,mt("measure","click",()=>this.toggle()),mt("end-measure","click",()=>this.toggle(!1)),mt("copy-measured","click",()=>Pi(this.words,b("copy-measured")))}toggle(t=!this.on){let{look:e}=this;this.on=t,this.ends=[],t&&e.selection.size===2&&(this.ends=[...e.selection].map(n=>this.middle(n))),b("measure").setAttribute("aria-pressed",String(t)),document.body.classList.toggle("measuring",t),this.show()}middle(t){let e=[...this.look.page.parts.center.subarray(3*t,3*t+3)];return{part:t,at:e,what:"centre of "}}click(t,e){let n=this.end(t,e);n&&(this.ends.length>1&&(this.ends=[]),this.ends.push(n),this.show())}end(t,e){let{stage:n}=this.look,s=n.hit(t,e);if(!s)return null;let r=n.shapeOf(s.part),[o,a]=[null,l0];for(let u of Xd(r)){let d=n.parts.carried(s.part,u),f=n.onScreen(d),m=f?Math.hypot(f[0]-t,f[1]-e):1/0;m<a&&([o,a]=[u,m])}let{part:l}=s;if(o)return{part:l,at:n.parts.rest(l,o),what:"corner of "};let[c,h]=[s.local,s.local.map((u,d)=>u+s.normal[d])].map(u=>n.parts.rest(l,u));return{part:l,at:c,normal:h.map((u,d)=>u-c[d]),what:""}}show(){let{page:t,stage:e}=this.look;b("measured").hidden=!this.on,b("copy-measured").hidden=this.ends.length<2,this.words=this.ends.length<2?"":this.tell();let n=this.ends.length?`From ${this.name(this.ends[0])}. Click the second point.`:"Click two points of parts. Near a corner, the corner counts. Two selected parts are measured between their centres.";b("measured-words").textContent=this.words||n,e.gauge.set(this.on?this.marks(t,e):{}),e.draw(),this.look.legend()}name({part:t,at:e,what:n}){let{page:s}=this.look,r=Nn(e.map((o,a)=>o+s.center[a]),5);return`${n}${Ri(s.parts.tails[t])} at ${r}`}tell(){let{units:t}=this.look.page,{distance:e,step:n,angle:s,between:r}=qd(...this.ends),[o,a,l]=n.map(h=>ve(h,6).replace("-","\u2212")),c=[`distance ${ve(e,6)} ${t}; dx ${o}, dy ${a}, dz ${l} ${t}`];return r!==null?c.push(`parallel faces, ${ve(r,6)} ${t} apart`):s!==null&&c.push(`angle between the surfaces there ${ai(s)}`),c.push(`from ${this.name(this.ends[0])} to ${this.name(this.ends[1])}`),c.join(`
`)}marks(t,e){let n=.014*t.radius,s=this.ends.map(l=>e.parts.placeOf(l.part,l.at)),r=s.map(l=>({at:l,along:[0,1,0],size:n}));if(s.length<2)return{ball:r};let o=s[1].map((l,c)=>l-s[0][c]),a=Math.hypot(...o);return{ball:r,rod:a?[{at:s[0],along:o,size:a,wide:8*n}]:[]}}follow(){this.on&&this.look.stage.gauge.set(this.marks(this.look.page,this.look.stage))}clear(){this.ends=[],this.on&&this.show()}};var _s=4,c0=140,h0=1;function u0(i,t,e,n,s,r,o,a){let l=n+1,c=d0(i,t,e,l);if(!c)return null;let[h,u]=[Math.max(0,c[0]-r),Math.max(0,c[1]-o)],[d,f]=[Math.min(t,c[2]+r+1),Math.min(e,c[3]+o+1)],[m,x]=[d-h+1,f-u+1],p=new Int32Array(m*x),g=new Int32Array(m*x);for(let T=1;T<x;T+=1)for(let A=1;A<m;A+=1){let _=(u+T-1)*t+h+A-1,[E,O]=[T*m+A,(T-1)*m+A],P=a[_]||i[_]&&i[_]!==l?1:0;p[E]=(i[_]===l&&!P?1:0)+p[E-1]+p[O]-p[O-1],g[E]=P+g[E-1]+g[O]-g[O-1]}let y=(T,A,_)=>T[(_+o)*m+A+r]-T[_*m+A+r]-T[(_+o)*m+A]+T[_*m+A],[w,S]=[null,1/0];for(let T=0;T+o<x;T+=1)for(let A=0;A+r<m;A+=1){if(y(g,A,T))continue;let _=y(p,A,T)/(r*o);if(_<.5)continue;let E=[h+A+r/2,u+T+o/2],O=Math.hypot(E[0]-s[0],E[1]-s[1])+(_<1?1e4*(1-_):0);O<S&&([w,S]=[E,O])}return w}function d0(i,t,e,n){let s=[1/0,1/0,-1,-1];for(let r=0;r<e;r+=1)for(let o=0;o<t;o+=1)i[r*t+o]===n&&(s[0]=Math.min(s[0],o),s[1]=Math.min(s[1],r),s[2]=Math.max(s[2],o),s[3]=Math.max(s[3],r));return s[2]<0?null:s}var Go=class{constructor(t,e){Object.assign(this,{element:t,stage:e}),this.tags=new Map}show(t){this.element.replaceChildren(),this.element.hidden=!t.length,this.tags=new Map(t.map(e=>{let n=document.createElement("span");return n.textContent=Ri(this.stage.page.parts.tails[e],24),this.element.append(n),[e,{element:n,off:null}]})),this.settle()}place(){for(let[t,{element:e,off:n}]of this.tags){let s=n&&this.stage.parts.shown(t)&&this.stage.onScreen(this.stage.parts.centre(t));e.style.visibility=s?"visible":"hidden",s&&(e.style.transform=`translate(${s[0]+n[0]}px, ${s[1]+n[1]}px) translate(-50%, -50%)`)}clearTimeout(this.waiting),this.tags.size&&(this.waiting=setTimeout(()=>this.settle(),c0))}settle(){let{stage:t,tags:e}=this;if(!e.size||!t.size)return;let{cells:n,width:s,height:r}=t.numbered(_s),o=new Uint8Array(n.length),{radius:a}=t.page.parts;for(let l of[...e.keys()].sort((c,h)=>a[h]-a[c])){let c=e.get(l),h=t.onScreen(t.parts.centre(l)),[u,d]=[c.element.offsetWidth,c.element.offsetHeight].map(m=>Math.ceil(m/_s)+2*h0),f=h&&u<s&&d<r&&u0(n,s,r,l,[h[0]/_s,h[1]/_s],u,d,o);c.off=f?[f[0]*_s-h[0],f[1]*_s-h[1]]:null,f&&f0(o,s,f,u,d)}this.place(),clearTimeout(this.waiting)}};function f0(i,t,[e,n],s,r){for(let o=Math.round(n-r/2);o<n+r/2;o+=1)i.fill(1,o*t+Math.round(e-s/2),o*t+Math.round(e+s/2))}var Vi={LEFT:0,MIDDLE:1,RIGHT:2,ROTATE:0,DOLLY:1,PAN:2},Hi={ROTATE:0,PAN:1,DOLLY_PAN:2,DOLLY_ROTATE:3},Lf=0,Ph=1,Df=2;var to=1,Nf=2,$s=3,bn=0,Ge=1,rn=2,as=0,Ys=1,Ih=2,Lh=3,Dh=4,il=5;var ls=100,Uf=101,Of=102,Ff=103,sl=104,Bf=200,eo=201,kf=202,zf=203,Nh=204,Uh=205,Gf=206,Vf=207,Hf=208,Wf=209,Xf=210,qf=211,$f=212,Yf=213,Zf=214,va=0,ya=1,ba=2,Us=3,Ma=4,Sa=5,wa=6,Ea=7,Oh=0,Jf=1,jf=2,ti=0,Fh=1,Bh=2,kh=3,zh=4,Gh=5,Vh=6,Hh=7;var Wh=300,cs=301,Zs=302,rl=303,ol=304,Aa=1e3,Yn=1001,Ta=1002,Ne=1003,Kf=1004;var no=1005;var Ye=1006,al=1007;var bi=1008;var Mn=1009,Xh=1010,qh=1011,Js=1012,ll=1013,kn=1014,fn=1015,zn=1016,cl=1017,hl=1018,hs=1020,$h=35902,Yh=35899,Zh=1021,Jh=1022,Sn=1023,gi=1026,Mi=1027,ul=1028,dl=1029,Wi=1030,fl=1031;var pl=1033,io=33776,so=33777,ro=33778,oo=33779,ml=35840,gl=35841,_l=35842,xl=35843,vl=36196,yl=37492,bl=37496,Ml=37488,Sl=37489,ao=37490,wl=37491,El=37808,Al=37809,Tl=37810,Cl=37811,Rl=37812,Pl=37813,Il=37814,Ll=37815,Dl=37816,Nl=37817,Ul=37818,Ol=37819,Fl=37820,Bl=37821,kl=36492,zl=36494,Gl=36495,Vl=36283,Hl=36284,lo=36285,Wl=36286;var Tr=2300,Ca=2301,xa=2302,xh=2303,vh=2400,yh=2401,bh=2402;var Qf=3200;var jh=0,tp=1,Si="",_n="srgb",ns="srgb-linear",Cr="linear",_e="srgb";var Ls=7680;var Kh=34055,Qh=34056;var tu=517;var Xl=519,ep=512,np=513,ip=514,eu=515,sp=516,rp=517,nu=518,iu=519,op=35044;var Gn="300 es",Cn=2e3,Rr=2001;function p0(i){for(let t=i.length-1;t>=0;--t)if(i[t]>=65535)return!0;return!1}function m0(i){return ArrayBuffer.isView(i)&&!(i instanceof DataView)}function Pr(i){return document.createElementNS("http://www.w3.org/1999/xhtml",i)}function ap(){let i=Pr("canvas");return i.style.display="block",i}var $d={},Os=null;function su(...i){let t="THREE."+i.shift();Os?Os("log",t,...i):console.log(t,...i)}function lp(i){let t=i[0];if(typeof t=="string"&&t.startsWith("TSL:")){let e=i[1];e&&e.isStackTrace?i[0]+=" "+e.getLocation():i[1]='Stack trace not available. Enable "THREE.Node.captureStackTrace" to capture stack traces.'}return i}function Vt(...i){i=lp(i);let t="THREE."+i.shift();if(Os)Os("warn",t,...i);else{let e=i[0];e&&e.isStackTrace?console.warn(e.getError(t)):console.warn(t,...i)}}function Wt(...i){i=lp(i);let t="THREE."+i.shift();if(Os)Os("error",t,...i);else{let e=i[0];e&&e.isStackTrace?console.error(e.getError(t)):console.error(t,...i)}}function Sr(...i){let t=i.join(" ");t in $d||($d[t]=!0,Vt(...i))}function cp(i,t,e){return new Promise(function(n,s){function r(){switch(i.clientWaitSync(t,i.SYNC_FLUSH_COMMANDS_BIT,0)){case i.WAIT_FAILED:s();break;case i.TIMEOUT_EXPIRED:setTimeout(r,e);break;default:n()}}setTimeout(r,e)})}var hp={[va]:va,[ba]:wa,[Ma]:Ma,[Us]:Sa,[ya]:ya,[wa]:ba,[Ea]:Ea,[Sa]:Us},Bn=class{addEventListener(t,e){this._listeners===void 0&&(this._listeners={});let n=this._listeners;n[t]===void 0&&(n[t]=[]),n[t].indexOf(e)===-1&&n[t].push(e)}hasEventListener(t,e){let n=this._listeners;return n===void 0?!1:n[t]!==void 0&&n[t].indexOf(e)!==-1}removeEventListener(t,e){let n=this._listeners;if(n===void 0)return;let s=n[t];if(s!==void 0){let r=s.indexOf(e);r!==-1&&s.splice(r,1)}}dispatchEvent(t){let e=this._listeners;if(e===void 0)return;let n=e[t.type];if(n!==void 0){t.target=this;let s=n.slice(0);for(let r=0,o=s.length;r<o;r++)s[r].call(this,t);t.target=null}}},en=["00","01","02","03","04","05","06","07","08","09","0a","0b","0c","0d","0e","0f","10","11","12","13","14","15","16","17","18","19","1a","1b","1c","1d","1e","1f","20","21","22","23","24","25","26","27","28","29","2a","2b","2c","2d","2e","2f","30","31","32","33","34","35","36","37","38","39","3a","3b","3c","3d","3e","3f","40","41","42","43","44","45","46","47","48","49","4a","4b","4c","4d","4e","4f","50","51","52","53","54","55","56","57","58","59","5a","5b","5c","5d","5e","5f","60","61","62","63","64","65","66","67","68","69","6a","6b","6c","6d","6e","6f","70","71","72","73","74","75","76","77","78","79","7a","7b","7c","7d","7e","7f","80","81","82","83","84","85","86","87","88","89","8a","8b","8c","8d","8e","8f","90","91","92","93","94","95","96","97","98","99","9a","9b","9c","9d","9e","9f","a0","a1","a2","a3","a4","a5","a6","a7","a8","a9","aa","ab","ac","ad","ae","af","b0","b1","b2","b3","b4","b5","b6","b7","b8","b9","ba","bb","bc","bd","be","bf","c0","c1","c2","c3","c4","c5","c6","c7","c8","c9","ca","cb","cc","cd","ce","cf","d0","d1","d2","d3","d4","d5","d6","d7","d8","d9","da","db","dc","dd","de","df","e0","e1","e2","e3","e4","e5","e6","e7","e8","e9","ea","eb","ec","ed","ee","ef","f0","f1","f2","f3","f4","f5","f6","f7","f8","f9","fa","fb","fc","fd","fe","ff"],Yd=1234567,Ds=Math.PI/180,Fs=180/Math.PI;function us(){let i=Math.random()*4294967295|0,t=Math.random()*4294967295|0,e=Math.random()*4294967295|0,n=Math.random()*4294967295|0;return(en[i&255]+en[i>>8&255]+en[i>>16&255]+en[i>>24&255]+"-"+en[t&255]+en[t>>8&255]+"-"+en[t>>16&15|64]+en[t>>24&255]+"-"+en[e&63|128]+en[e>>8&255]+"-"+en[e>>16&255]+en[e>>24&255]+en[n&255]+en[n>>8&255]+en[n>>16&255]+en[n>>24&255]).toLowerCase()}function ee(i,t,e){return Math.max(t,Math.min(e,i))}function ru(i,t){return(i%t+t)%t}function g0(i,t,e,n,s){return n+(i-t)*(s-n)/(e-t)}function _0(i,t,e){return i!==t?(e-i)/(t-i):0}function wr(i,t,e){return(1-e)*i+e*t}function x0(i,t,e,n){return wr(i,t,1-Math.exp(-e*n))}function v0(i,t=1){return t-Math.abs(ru(i,t*2)-t)}function y0(i,t,e){return i<=t?0:i>=e?1:(i=(i-t)/(e-t),i*i*(3-2*i))}function b0(i,t,e){return i<=t?0:i>=e?1:(i=(i-t)/(e-t),i*i*i*(i*(i*6-15)+10))}function M0(i,t){return i+Math.floor(Math.random()*(t-i+1))}function S0(i,t){return i+Math.random()*(t-i)}function w0(i){return i*(.5-Math.random())}function E0(i){i!==void 0&&(Yd=i);let t=Yd+=1831565813;return t=Math.imul(t^t>>>15,t|1),t^=t+Math.imul(t^t>>>7,t|61),((t^t>>>14)>>>0)/4294967296}function A0(i){return i*Ds}function T0(i){return i*Fs}function C0(i){return i>0&&Number.isInteger(i)&&2**Math.round(Math.log2(i))===i}function R0(i){return Math.pow(2,Math.ceil(Math.log(i)/Math.LN2))}function ou(i){return Math.pow(2,Math.floor(Math.log(i)/Math.LN2))}function P0(i,t,e,n,s){let r=Math.cos,o=Math.sin,a=r(e/2),l=o(e/2),c=r((t+n)/2),h=o((t+n)/2),u=r((t-n)/2),d=o((t-n)/2),f=r((n-t)/2),m=o((n-t)/2);switch(s){case"XYX":i.set(a*h,l*u,l*d,a*c);break;case"YZY":i.set(l*d,a*h,l*u,a*c);break;case"ZXZ":i.set(l*u,l*d,a*h,a*c);break;case"XZX":i.set(a*h,l*m,l*f,a*c);break;case"YXY":i.set(l*f,a*h,l*m,a*c);break;case"ZYZ":i.set(l*m,l*f,a*h,a*c);break;default:Vt("MathUtils: .setQuaternionFromProperEuler() encountered an unknown order: "+s)}}function au(i){switch(i.constructor){case Uint32Array:return 4294967295;case Uint16Array:return 65535;case Uint8Array:case Uint8ClampedArray:return 255;case Int32Array:return 2147483647;case Int16Array:return 32767;case Int8Array:return 127;default:return}}function up(i,t){if(t.constructor===Float32Array)return i;let e=au(t);if(e===void 0)throw new Error("THREE.MathUtils: Invalid component type.");return Math.max(i/e,-1)}function dp(i,t){if(t.constructor===Float32Array)return i;let e=au(t);if(e===void 0)throw new Error("THREE.MathUtils: Invalid component type.");return Math.round(i*e)}var lu={DEG2RAD:Ds,RAD2DEG:Fs,generateUUID:us,clamp:ee,euclideanModulo:ru,mapLinear:g0,inverseLerp:_0,lerp:wr,damp:x0,pingpong:v0,smoothstep:y0,smootherstep:b0,randInt:M0,randFloat:S0,randFloatSpread:w0,seededRandom:E0,degToRad:A0,radToDeg:T0,isPowerOfTwo:C0,ceilPowerOfTwo:R0,floorPowerOfTwo:ou,setQuaternionFromProperEuler:P0,normalize:dp,denormalize:up},rt=class{static{this.prototype.isVector2=!0}constructor(t=0,e=0){this.x=t,this.y=e}get width(){return this.x}set width(t){this.x=t}get height(){return this.y}set height(t){this.y=t}set(t,e){return this.x=t,this.y=e,this}setScalar(t){return this.x=t,this.y=t,this}setX(t){return this.x=t,this}setY(t){return this.y=t,this}setComponent(t,e){switch(t){case 0:this.x=e;break;case 1:this.y=e;break;default:throw new Error("THREE.Vector2: index is out of range: "+t)}return this}getComponent(t){switch(t){case 0:return this.x;case 1:return this.y;default:throw new Error("THREE.Vector2: index is out of range: "+t)}}clone(){return new this.constructor(this.x,this.y)}copy(t){return this.x=t.x,this.y=t.y,this}add(t){return this.x+=t.x,this.y+=t.y,this}addScalar(t){return this.x+=t,this.y+=t,this}addVectors(t,e){return this.x=t.x+e.x,this.y=t.y+e.y,this}addScaledVector(t,e){return this.x+=t.x*e,this.y+=t.y*e,this}sub(t){return this.x-=t.x,this.y-=t.y,this}subScalar(t){return this.x-=t,this.y-=t,this}subVectors(t,e){return this.x=t.x-e.x,this.y=t.y-e.y,this}multiply(t){return this.x*=t.x,this.y*=t.y,this}multiplyScalar(t){return this.x*=t,this.y*=t,this}divide(t){return this.x/=t.x,this.y/=t.y,this}divideScalar(t){return this.multiplyScalar(1/t)}applyMatrix3(t){let e=this.x,n=this.y,s=t.elements;return this.x=s[0]*e+s[3]*n+s[6],this.y=s[1]*e+s[4]*n+s[7],this}min(t){return this.x=Math.min(this.x,t.x),this.y=Math.min(this.y,t.y),this}max(t){return this.x=Math.max(this.x,t.x),this.y=Math.max(this.y,t.y),this}clamp(t,e){return this.x=ee(this.x,t.x,e.x),this.y=ee(this.y,t.y,e.y),this}clampScalar(t,e){return this.x=ee(this.x,t,e),this.y=ee(this.y,t,e),this}clampLength(t,e){let n=this.length();return this.divideScalar(n||1).multiplyScalar(ee(n,t,e))}floor(){return this.x=Math.floor(this.x),this.y=Math.floor(this.y),this}ceil(){return this.x=Math.ceil(this.x),this.y=Math.ceil(this.y),this}round(){return this.x=Math.round(this.x),this.y=Math.round(this.y),this}roundToZero(){return this.x=Math.trunc(this.x),this.y=Math.trunc(this.y),this}negate(){return this.x=-this.x,this.y=-this.y,this}dot(t){return this.x*t.x+this.y*t.y}cross(t){return this.x*t.y-this.y*t.x}lengthSq(){return this.x*this.x+this.y*this.y}length(){return Math.sqrt(this.x*this.x+this.y*this.y)}manhattanLength(){return Math.abs(this.x)+Math.abs(this.y)}normalize(){return this.divideScalar(this.length()||1)}angle(){return Math.atan2(-this.y,-this.x)+Math.PI}angleTo(t){let e=Math.sqrt(this.lengthSq()*t.lengthSq());if(e===0)return Math.PI/2;let n=this.dot(t)/e;return Math.acos(ee(n,-1,1))}distanceTo(t){return Math.sqrt(this.distanceToSquared(t))}distanceToSquared(t){let e=this.x-t.x,n=this.y-t.y;return e*e+n*n}manhattanDistanceTo(t){return Math.abs(this.x-t.x)+Math.abs(this.y-t.y)}setLength(t){return this.normalize().multiplyScalar(t)}lerp(t,e){return this.x+=(t.x-this.x)*e,this.y+=(t.y-this.y)*e,this}lerpVectors(t,e,n){return this.x=t.x+(e.x-t.x)*n,this.y=t.y+(e.y-t.y)*n,this}equals(t){return t.x===this.x&&t.y===this.y}fromArray(t,e=0){return this.x=t[e],this.y=t[e+1],this}toArray(t=[],e=0){return t[e]=this.x,t[e+1]=this.y,t}fromBufferAttribute(t,e){return this.x=t.getX(e),this.y=t.getY(e),this}rotateAround(t,e){let n=Math.cos(e),s=Math.sin(e),r=this.x-t.x,o=this.y-t.y;return this.x=r*n-o*s+t.x,this.y=r*s+o*n+t.y,this}random(){return this.x=Math.random(),this.y=Math.random(),this}*[Symbol.iterator](){yield this.x,yield this.y}},Ue=class{constructor(t=0,e=0,n=0,s=1){this.isQuaternion=!0,this._x=t,this._y=e,this._z=n,this._w=s}static slerpFlat(t,e,n,s,r,o,a){let l=n[s+0],c=n[s+1],h=n[s+2],u=n[s+3],d=r[o+0],f=r[o+1],m=r[o+2],x=r[o+3];if(u!==x||l!==d||c!==f||h!==m){let p=l*d+c*f+h*m+u*x;p<0&&(d=-d,f=-f,m=-m,x=-x,p=-p);let g=1-a;if(p<.9995){let y=Math.acos(p),w=Math.sin(y);g=Math.sin(g*y)/w,a=Math.sin(a*y)/w,l=l*g+d*a,c=c*g+f*a,h=h*g+m*a,u=u*g+x*a}else{l=l*g+d*a,c=c*g+f*a,h=h*g+m*a,u=u*g+x*a;let y=1/Math.sqrt(l*l+c*c+h*h+u*u);l*=y,c*=y,h*=y,u*=y}}t[e]=l,t[e+1]=c,t[e+2]=h,t[e+3]=u}static multiplyQuaternionsFlat(t,e,n,s,r,o){let a=n[s],l=n[s+1],c=n[s+2],h=n[s+3],u=r[o],d=r[o+1],f=r[o+2],m=r[o+3];return t[e]=a*m+h*u+l*f-c*d,t[e+1]=l*m+h*d+c*u-a*f,t[e+2]=c*m+h*f+a*d-l*u,t[e+3]=h*m-a*u-l*d-c*f,t}get x(){return this._x}set x(t){this._x=t,this._onChangeCallback()}get y(){return this._y}set y(t){this._y=t,this._onChangeCallback()}get z(){return this._z}set z(t){this._z=t,this._onChangeCallback()}get w(){return this._w}set w(t){this._w=t,this._onChangeCallback()}set(t,e,n,s){return this._x=t,this._y=e,this._z=n,this._w=s,this._onChangeCallback(),this}clone(){return new this.constructor(this._x,this._y,this._z,this._w)}copy(t){return this._x=t.x,this._y=t.y,this._z=t.z,this._w=t.w,this._onChangeCallback(),this}setFromEuler(t,e=!0){let n=t._x,s=t._y,r=t._z,o=t._order,a=Math.cos,l=Math.sin,c=a(n/2),h=a(s/2),u=a(r/2),d=l(n/2),f=l(s/2),m=l(r/2);switch(o){case"XYZ":this._x=d*h*u+c*f*m,this._y=c*f*u-d*h*m,this._z=c*h*m+d*f*u,this._w=c*h*u-d*f*m;break;case"YXZ":this._x=d*h*u+c*f*m,this._y=c*f*u-d*h*m,this._z=c*h*m-d*f*u,this._w=c*h*u+d*f*m;break;case"ZXY":this._x=d*h*u-c*f*m,this._y=c*f*u+d*h*m,this._z=c*h*m+d*f*u,this._w=c*h*u-d*f*m;break;case"ZYX":this._x=d*h*u-c*f*m,this._y=c*f*u+d*h*m,this._z=c*h*m-d*f*u,this._w=c*h*u+d*f*m;break;case"YZX":this._x=d*h*u+c*f*m,this._y=c*f*u+d*h*m,this._z=c*h*m-d*f*u,this._w=c*h*u-d*f*m;break;case"XZY":this._x=d*h*u-c*f*m,this._y=c*f*u-d*h*m,this._z=c*h*m+d*f*u,this._w=c*h*u+d*f*m;break;default:Vt("Quaternion: .setFromEuler() encountered an unknown order: "+o)}return e===!0&&this._onChangeCallback(),this}setFromAxisAngle(t,e){let n=e/2,s=Math.sin(n);return this._x=t.x*s,this._y=t.y*s,this._z=t.z*s,this._w=Math.cos(n),this._onChangeCallback(),this}setFromRotationMatrix(t){let e=t.elements,n=e[0],s=e[4],r=e[8],o=e[1],a=e[5],l=e[9],c=e[2],h=e[6],u=e[10],d=n+a+u;if(d>0){let f=.5/Math.sqrt(d+1);this._w=.25/f,this._x=(h-l)*f,this._y=(r-c)*f,this._z=(o-s)*f}else if(n>a&&n>u){let f=2*Math.sqrt(1+n-a-u);this._w=(h-l)/f,this._x=.25*f,this._y=(s+o)/f,this._z=(r+c)/f}else if(a>u){let f=2*Math.sqrt(1+a-n-u);this._w=(r-c)/f,this._x=(s+o)/f,this._y=.25*f,this._z=(l+h)/f}else{let f=2*Math.sqrt(1+u-n-a);this._w=(o-s)/f,this._x=(r+c)/f,this._y=(l+h)/f,this._z=.25*f}return this._onChangeCallback(),this}setFromUnitVectors(t,e){let n=t.dot(e)+1;return n<1e-8?(n=0,Math.abs(t.x)>Math.abs(t.z)?(this._x=-t.y,this._y=t.x,this._z=0,this._w=n):(this._x=0,this._y=-t.z,this._z=t.y,this._w=n)):(this._x=t.y*e.z-t.z*e.y,this._y=t.z*e.x-t.x*e.z,this._z=t.x*e.y-t.y*e.x,this._w=n),this.normalize()}angleTo(t){return 2*Math.acos(Math.abs(ee(this.dot(t),-1,1)))}rotateTowards(t,e){let n=this.angleTo(t);if(n===0)return this;let s=Math.min(1,e/n);return this.slerp(t,s),this}identity(){return this.set(0,0,0,1)}invert(){return this.conjugate()}conjugate(){return this._x*=-1,this._y*=-1,this._z*=-1,this._onChangeCallback(),this}dot(t){return this._x*t._x+this._y*t._y+this._z*t._z+this._w*t._w}lengthSq(){return this._x*this._x+this._y*this._y+this._z*this._z+this._w*this._w}length(){return Math.sqrt(this._x*this._x+this._y*this._y+this._z*this._z+this._w*this._w)}normalize(){let t=this.length();return t===0?(this._x=0,this._y=0,this._z=0,this._w=1):(t=1/t,this._x=this._x*t,this._y=this._y*t,this._z=this._z*t,this._w=this._w*t),this._onChangeCallback(),this}multiply(t){return this.multiplyQuaternions(this,t)}premultiply(t){return this.multiplyQuaternions(t,this)}multiplyQuaternions(t,e){let n=t._x,s=t._y,r=t._z,o=t._w,a=e._x,l=e._y,c=e._z,h=e._w;return this._x=n*h+o*a+s*c-r*l,this._y=s*h+o*l+r*a-n*c,this._z=r*h+o*c+n*l-s*a,this._w=o*h-n*a-s*l-r*c,this._onChangeCallback(),this}slerp(t,e){let n=t._x,s=t._y,r=t._z,o=t._w,a=this.dot(t);a<0&&(n=-n,s=-s,r=-r,o=-o,a=-a);let l=1-e;if(a<.9995){let c=Math.acos(a),h=Math.sin(c);l=Math.sin(l*c)/h,e=Math.sin(e*c)/h,this._x=this._x*l+n*e,this._y=this._y*l+s*e,this._z=this._z*l+r*e,this._w=this._w*l+o*e,this._onChangeCallback()}else this._x=this._x*l+n*e,this._y=this._y*l+s*e,this._z=this._z*l+r*e,this._w=this._w*l+o*e,this.normalize();return this}slerpQuaternions(t,e,n){return this.copy(t).slerp(e,n)}random(){let t=2*Math.PI*Math.random(),e=2*Math.PI*Math.random(),n=Math.random(),s=Math.sqrt(1-n),r=Math.sqrt(n);return this.set(s*Math.sin(t),s*Math.cos(t),r*Math.sin(e),r*Math.cos(e))}equals(t){return t._x===this._x&&t._y===this._y&&t._z===this._z&&t._w===this._w}fromArray(t,e=0){return this._x=t[e],this._y=t[e+1],this._z=t[e+2],this._w=t[e+3],this._onChangeCallback(),this}toArray(t=[],e=0){return t[e]=this._x,t[e+1]=this._y,t[e+2]=this._z,t[e+3]=this._w,t}fromBufferAttribute(t,e){return this._x=t.getX(e),this._y=t.getY(e),this._z=t.getZ(e),this._w=t.getW(e),this._onChangeCallback(),this}toJSON(){return this.toArray()}_onChange(t){return this._onChangeCallback=t,this}_onChangeCallback(){}*[Symbol.iterator](){yield this._x,yield this._y,yield this._z,yield this._w}},I=class{static{this.prototype.isVector3=!0}constructor(t=0,e=0,n=0){this.x=t,this.y=e,this.z=n}set(t,e,n){return n===void 0&&(n=this.z),this.x=t,this.y=e,this.z=n,this}setScalar(t){return this.x=t,this.y=t,this.z=t,this}setX(t){return this.x=t,this}setY(t){return this.y=t,this}setZ(t){return this.z=t,this}setComponent(t,e){switch(t){case 0:this.x=e;break;case 1:this.y=e;break;case 2:this.z=e;break;default:throw new Error("THREE.Vector3: index is out of range: "+t)}return this}getComponent(t){switch(t){case 0:return this.x;case 1:return this.y;case 2:return this.z;default:throw new Error("THREE.Vector3: index is out of range: "+t)}}clone(){return new this.constructor(this.x,this.y,this.z)}copy(t){return this.x=t.x,this.y=t.y,this.z=t.z,this}add(t){return this.x+=t.x,this.y+=t.y,this.z+=t.z,this}addScalar(t){return this.x+=t,this.y+=t,this.z+=t,this}addVectors(t,e){return this.x=t.x+e.x,this.y=t.y+e.y,this.z=t.z+e.z,this}addScaledVector(t,e){return this.x+=t.x*e,this.y+=t.y*e,this.z+=t.z*e,this}sub(t){return this.x-=t.x,this.y-=t.y,this.z-=t.z,this}subScalar(t){return this.x-=t,this.y-=t,this.z-=t,this}subVectors(t,e){return this.x=t.x-e.x,this.y=t.y-e.y,this.z=t.z-e.z,this}multiply(t){return this.x*=t.x,this.y*=t.y,this.z*=t.z,this}multiplyScalar(t){return this.x*=t,this.y*=t,this.z*=t,this}multiplyVectors(t,e){return this.x=t.x*e.x,this.y=t.y*e.y,this.z=t.z*e.z,this}applyEuler(t){return this.applyQuaternion(Zd.setFromEuler(t))}applyAxisAngle(t,e){return this.applyQuaternion(Zd.setFromAxisAngle(t,e))}applyMatrix3(t){let e=this.x,n=this.y,s=this.z,r=t.elements;return this.x=r[0]*e+r[3]*n+r[6]*s,this.y=r[1]*e+r[4]*n+r[7]*s,this.z=r[2]*e+r[5]*n+r[8]*s,this}applyNormalMatrix(t){return this.applyMatrix3(t).normalize()}applyMatrix4(t){let e=this.x,n=this.y,s=this.z,r=t.elements,o=1/(r[3]*e+r[7]*n+r[11]*s+r[15]);return this.x=(r[0]*e+r[4]*n+r[8]*s+r[12])*o,this.y=(r[1]*e+r[5]*n+r[9]*s+r[13])*o,this.z=(r[2]*e+r[6]*n+r[10]*s+r[14])*o,this}applyQuaternion(t){let e=this.x,n=this.y,s=this.z,r=t.x,o=t.y,a=t.z,l=t.w,c=2*(o*s-a*n),h=2*(a*e-r*s),u=2*(r*n-o*e);return this.x=e+l*c+o*u-a*h,this.y=n+l*h+a*c-r*u,this.z=s+l*u+r*h-o*c,this}project(t){return this.applyMatrix4(t.matrixWorldInverse).applyMatrix4(t.projectionMatrix)}unproject(t){return this.applyMatrix4(t.projectionMatrixInverse).applyMatrix4(t.matrixWorld)}transformDirection(t){let e=this.x,n=this.y,s=this.z,r=t.elements;return this.x=r[0]*e+r[4]*n+r[8]*s,this.y=r[1]*e+r[5]*n+r[9]*s,this.z=r[2]*e+r[6]*n+r[10]*s,this.normalize()}divide(t){return this.x/=t.x,this.y/=t.y,this.z/=t.z,this}divideScalar(t){return this.multiplyScalar(1/t)}min(t){return this.x=Math.min(this.x,t.x),this.y=Math.min(this.y,t.y),this.z=Math.min(this.z,t.z),this}max(t){return this.x=Math.max(this.x,t.x),this.y=Math.max(this.y,t.y),this.z=Math.max(this.z,t.z),this}clamp(t,e){return this.x=ee(this.x,t.x,e.x),this.y=ee(this.y,t.y,e.y),this.z=ee(this.z,t.z,e.z),this}clampScalar(t,e){return this.x=ee(this.x,t,e),this.y=ee(this.y,t,e),this.z=ee(this.z,t,e),this}clampLength(t,e){let n=this.length();return this.divideScalar(n||1).multiplyScalar(ee(n,t,e))}floor(){return this.x=Math.floor(this.x),this.y=Math.floor(this.y),this.z=Math.floor(this.z),this}ceil(){return this.x=Math.ceil(this.x),this.y=Math.ceil(this.y),this.z=Math.ceil(this.z),this}round(){return this.x=Math.round(this.x),this.y=Math.round(this.y),this.z=Math.round(this.z),this}roundToZero(){return this.x=Math.trunc(this.x),this.y=Math.trunc(this.y),this.z=Math.trunc(this.z),this}negate(){return this.x=-this.x,this.y=-this.y,this.z=-this.z,this}dot(t){return this.x*t.x+this.y*t.y+this.z*t.z}lengthSq(){return this.x*this.x+this.y*this.y+this.z*this.z}length(){return Math.sqrt(this.x*this.x+this.y*this.y+this.z*this.z)}manhattanLength(){return Math.abs(this.x)+Math.abs(this.y)+Math.abs(this.z)}normalize(){return this.divideScalar(this.length()||1)}setLength(t){return this.normalize().multiplyScalar(t)}lerp(t,e){return this.x+=(t.x-this.x)*e,this.y+=(t.y-this.y)*e,this.z+=(t.z-this.z)*e,this}lerpVectors(t,e,n){return this.x=t.x+(e.x-t.x)*n,this.y=t.y+(e.y-t.y)*n,this.z=t.z+(e.z-t.z)*n,this}cross(t){return this.crossVectors(this,t)}crossVectors(t,e){let n=t.x,s=t.y,r=t.z,o=e.x,a=e.y,l=e.z;return this.x=s*l-r*a,this.y=r*o-n*l,this.z=n*a-s*o,this}projectOnVector(t){let e=t.lengthSq();if(e===0)return this.set(0,0,0);let n=t.dot(this)/e;return this.copy(t).multiplyScalar(n)}projectOnPlane(t){return Yc.copy(this).projectOnVector(t),this.sub(Yc)}reflect(t){return this.sub(Yc.copy(t).multiplyScalar(2*this.dot(t)))}angleTo(t){let e=Math.sqrt(this.lengthSq()*t.lengthSq());if(e===0)return Math.PI/2;let n=this.dot(t)/e;return Math.acos(ee(n,-1,1))}distanceTo(t){return Math.sqrt(this.distanceToSquared(t))}distanceToSquared(t){let e=this.x-t.x,n=this.y-t.y,s=this.z-t.z;return e*e+n*n+s*s}manhattanDistanceTo(t){return Math.abs(this.x-t.x)+Math.abs(this.y-t.y)+Math.abs(this.z-t.z)}setFromSpherical(t){return this.setFromSphericalCoords(t.radius,t.phi,t.theta)}setFromSphericalCoords(t,e,n){let s=Math.sin(e)*t;return this.x=s*Math.sin(n),this.y=Math.cos(e)*t,this.z=s*Math.cos(n),this}setFromCylindrical(t){return this.setFromCylindricalCoords(t.radius,t.theta,t.y)}setFromCylindricalCoords(t,e,n){return this.x=t*Math.sin(e),this.y=n,this.z=t*Math.cos(e),this}setFromMatrixPosition(t){let e=t.elements;return this.x=e[12],this.y=e[13],this.z=e[14],this}setFromMatrixScale(t){let e=this.setFromMatrixColumn(t,0).length(),n=this.setFromMatrixColumn(t,1).length(),s=this.setFromMatrixColumn(t,2).length();return this.x=e,this.y=n,this.z=s,this}setFromMatrixColumn(t,e){return this.fromArray(t.elements,e*4)}setFromMatrix3Column(t,e){return this.fromArray(t.elements,e*3)}setFromEuler(t){return this.x=t._x,this.y=t._y,this.z=t._z,this}setFromColor(t){return this.x=t.r,this.y=t.g,this.z=t.b,this}equals(t){return t.x===this.x&&t.y===this.y&&t.z===this.z}fromArray(t,e=0){return this.x=t[e],this.y=t[e+1],this.z=t[e+2],this}toArray(t=[],e=0){return t[e]=this.x,t[e+1]=this.y,t[e+2]=this.z,t}fromBufferAttribute(t,e){return this.x=t.getX(e),this.y=t.getY(e),this.z=t.getZ(e),this}random(){return this.x=Math.random(),this.y=Math.random(),this.z=Math.random(),this}randomDirection(){let t=Math.random()*Math.PI*2,e=Math.random()*2-1,n=Math.sqrt(1-e*e);return this.x=n*Math.cos(t),this.y=e,this.z=n*Math.sin(t),this}*[Symbol.iterator](){yield this.x,yield this.y,yield this.z}},Yc=new I,Zd=new Ue,$t=class{static{this.prototype.isMatrix3=!0}constructor(t,e,n,s,r,o,a,l,c){this.elements=[1,0,0,0,1,0,0,0,1],t!==void 0&&this.set(t,e,n,s,r,o,a,l,c)}set(t,e,n,s,r,o,a,l,c){let h=this.elements;return h[0]=t,h[1]=s,h[2]=a,h[3]=e,h[4]=r,h[5]=l,h[6]=n,h[7]=o,h[8]=c,this}identity(){return this.set(1,0,0,0,1,0,0,0,1),this}copy(t){let e=this.elements,n=t.elements;return e[0]=n[0],e[1]=n[1],e[2]=n[2],e[3]=n[3],e[4]=n[4],e[5]=n[5],e[6]=n[6],e[7]=n[7],e[8]=n[8],this}extractBasis(t,e,n){return t.setFromMatrix3Column(this,0),e.setFromMatrix3Column(this,1),n.setFromMatrix3Column(this,2),this}setFromMatrix4(t){let e=t.elements;return this.set(e[0],e[4],e[8],e[1],e[5],e[9],e[2],e[6],e[10]),this}multiply(t){return this.multiplyMatrices(this,t)}premultiply(t){return this.multiplyMatrices(t,this)}multiplyMatrices(t,e){let n=t.elements,s=e.elements,r=this.elements,o=n[0],a=n[3],l=n[6],c=n[1],h=n[4],u=n[7],d=n[2],f=n[5],m=n[8],x=s[0],p=s[3],g=s[6],y=s[1],w=s[4],S=s[7],T=s[2],A=s[5],_=s[8];return r[0]=o*x+a*y+l*T,r[3]=o*p+a*w+l*A,r[6]=o*g+a*S+l*_,r[1]=c*x+h*y+u*T,r[4]=c*p+h*w+u*A,r[7]=c*g+h*S+u*_,r[2]=d*x+f*y+m*T,r[5]=d*p+f*w+m*A,r[8]=d*g+f*S+m*_,this}multiplyScalar(t){let e=this.elements;return e[0]*=t,e[3]*=t,e[6]*=t,e[1]*=t,e[4]*=t,e[7]*=t,e[2]*=t,e[5]*=t,e[8]*=t,this}determinant(){let t=this.elements,e=t[0],n=t[1],s=t[2],r=t[3],o=t[4],a=t[5],l=t[6],c=t[7],h=t[8];return e*o*h-e*a*c-n*r*h+n*a*l+s*r*c-s*o*l}invert(){let t=this.elements,e=t[0],n=t[1],s=t[2],r=t[3],o=t[4],a=t[5],l=t[6],c=t[7],h=t[8],u=h*o-a*c,d=a*l-h*r,f=c*r-o*l,m=e*u+n*d+s*f;if(m===0)return this.set(0,0,0,0,0,0,0,0,0);let x=1/m;return t[0]=u*x,t[1]=(s*c-h*n)*x,t[2]=(a*n-s*o)*x,t[3]=d*x,t[4]=(h*e-s*l)*x,t[5]=(s*r-a*e)*x,t[6]=f*x,t[7]=(n*l-c*e)*x,t[8]=(o*e-n*r)*x,this}transpose(){let t,e=this.elements;return t=e[1],e[1]=e[3],e[3]=t,t=e[2],e[2]=e[6],e[6]=t,t=e[5],e[5]=e[7],e[7]=t,this}getNormalMatrix(t){return this.setFromMatrix4(t).invert().transpose()}transposeIntoArray(t){let e=this.elements;return t[0]=e[0],t[1]=e[3],t[2]=e[6],t[3]=e[1],t[4]=e[4],t[5]=e[7],t[6]=e[2],t[7]=e[5],t[8]=e[8],this}setUvTransform(t,e,n,s,r,o,a){let l=Math.cos(r),c=Math.sin(r);return this.set(n*l,n*c,-n*(l*o+c*a)+o+t,-s*c,s*l,-s*(-c*o+l*a)+a+e,0,0,1),this}scale(t,e){return Sr("Matrix3: .scale() is deprecated. Use .makeScale() instead."),this.premultiply(Zc.makeScale(t,e)),this}rotate(t){return Sr("Matrix3: .rotate() is deprecated. Use .makeRotation() instead."),this.premultiply(Zc.makeRotation(-t)),this}translate(t,e){return Sr("Matrix3: .translate() is deprecated. Use .makeTranslation() instead."),this.premultiply(Zc.makeTranslation(t,e)),this}makeTranslation(t,e){return t.isVector2?this.set(1,0,t.x,0,1,t.y,0,0,1):this.set(1,0,t,0,1,e,0,0,1),this}makeRotation(t){let e=Math.cos(t),n=Math.sin(t);return this.set(e,-n,0,n,e,0,0,0,1),this}makeScale(t,e){return this.set(t,0,0,0,e,0,0,0,1),this}equals(t){let e=this.elements,n=t.elements;for(let s=0;s<9;s++)if(e[s]!==n[s])return!1;return!0}fromArray(t,e=0){for(let n=0;n<9;n++)this.elements[n]=t[n+e];return this}toArray(t=[],e=0){let n=this.elements;return t[e]=n[0],t[e+1]=n[1],t[e+2]=n[2],t[e+3]=n[3],t[e+4]=n[4],t[e+5]=n[5],t[e+6]=n[6],t[e+7]=n[7],t[e+8]=n[8],t}clone(){return new this.constructor().fromArray(this.elements)}},Zc=new $t,Jd=new $t().set(.4123908,.3575843,.1804808,.212639,.7151687,.0721923,.0193308,.1191948,.9505322),jd=new $t().set(3.2409699,-1.5373832,-.4986108,-.9692436,1.8759675,.0415551,.0556301,-.203977,1.0569715);function I0(){let i={enabled:!0,workingColorSpace:ns,spaces:{},convert:function(s,r,o){return this.enabled===!1||r===o||!r||!o||(this.spaces[r].transfer===_e&&(s.r=mi(s.r),s.g=mi(s.g),s.b=mi(s.b)),this.spaces[r].primaries!==this.spaces[o].primaries&&(s.applyMatrix3(this.spaces[r].toXYZ),s.applyMatrix3(this.spaces[o].fromXYZ)),this.spaces[o].transfer===_e&&(s.r=Ns(s.r),s.g=Ns(s.g),s.b=Ns(s.b))),s},workingToColorSpace:function(s,r){return this.convert(s,this.workingColorSpace,r)},colorSpaceToWorking:function(s,r){return this.convert(s,r,this.workingColorSpace)},getPrimaries:function(s){return this.spaces[s].primaries},getTransfer:function(s){return s===Si?Cr:this.spaces[s].transfer},getToneMappingMode:function(s){return this.spaces[s].outputColorSpaceConfig.toneMappingMode||"standard"},getLuminanceCoefficients:function(s,r=this.workingColorSpace){return s.fromArray(this.spaces[r].luminanceCoefficients)},define:function(s){Object.assign(this.spaces,s)},_getMatrix:function(s,r,o){return s.copy(this.spaces[o].fromXYZ).multiply(this.spaces[r].toXYZ)},_getDrawingBufferColorSpace:function(s){return this.spaces[s].outputColorSpaceConfig.drawingBufferColorSpace},_getUnpackColorSpace:function(s=this.workingColorSpace){return this.spaces[s].workingColorSpaceConfig.unpackColorSpace}},t=[.64,.33,.3,.6,.15,.06],e=[.2126,.7152,.0722],n=[.3127,.329];return i.define({[ns]:{primaries:t,whitePoint:n,transfer:Cr,toXYZ:Jd,fromXYZ:jd,luminanceCoefficients:e,workingColorSpaceConfig:{unpackColorSpace:_n},outputColorSpaceConfig:{drawingBufferColorSpace:_n}},[_n]:{primaries:t,whitePoint:n,transfer:_e,toXYZ:Jd,fromXYZ:jd,luminanceCoefficients:e,outputColorSpaceConfig:{drawingBufferColorSpace:_n}}}),i}var se=I0();function mi(i){return i<.04045?i*.0773993808:Math.pow(i*.9478672986+.0521327014,2.4)}function Ns(i){return i<.0031308?i*12.92:1.055*Math.pow(i,.41666)-.055}var xs,Ra=class{static getDataURL(t,e="image/png"){if(/^data:/i.test(t.src)||typeof HTMLCanvasElement>"u")return t.src;let n;if(t instanceof HTMLCanvasElement)n=t;else{xs===void 0&&(xs=Pr("canvas")),xs.width=t.width,xs.height=t.height;let s=xs.getContext("2d");t instanceof ImageData?s.putImageData(t,0,0):s.drawImage(t,0,0,t.width,t.height),n=xs}return n.toDataURL(e)}static sRGBToLinear(t){if(typeof HTMLImageElement<"u"&&t instanceof HTMLImageElement||typeof HTMLCanvasElement<"u"&&t instanceof HTMLCanvasElement||typeof ImageBitmap<"u"&&t instanceof ImageBitmap){let e=Pr("canvas");e.width=t.width,e.height=t.height;let n=e.getContext("2d");n.drawImage(t,0,0,t.width,t.height);let s=n.getImageData(0,0,t.width,t.height),r=s.data;for(let o=0;o<r.length;o++)r[o]=mi(r[o]/255)*255;return n.putImageData(s,0,0),e}else if(t.data){let e=t.data.slice(0);for(let n=0;n<e.length;n++)e instanceof Uint8Array||e instanceof Uint8ClampedArray?e[n]=Math.floor(mi(e[n]/255)*255):e[n]=mi(e[n]);return{data:e,width:t.width,height:t.height}}else return Vt("ImageUtils.sRGBToLinear(): Unsupported image type. No color space conversion applied."),t}},L0=0,Bs=class{constructor(t=null){this.isTextureSource=!0,Object.defineProperty(this,"id",{value:L0++}),this.uuid=us(),this.data=t,this.dataReady=!0,this.version=0}getSize(t){let e=this.data;return typeof HTMLVideoElement<"u"&&e instanceof HTMLVideoElement?t.set(e.videoWidth,e.videoHeight,0):typeof VideoFrame<"u"&&e instanceof VideoFrame?t.set(e.displayWidth,e.displayHeight,0):e!==null?t.set(e.width||0,e.height||0,e.depth||0):t.set(0,0,0),t}set needsUpdate(t){t===!0&&this.version++}toJSON(t){let e=t===void 0||typeof t=="string";if(!e&&t.images[this.uuid]!==void 0)return t.images[this.uuid];let n={uuid:this.uuid,url:""},s=this.data;if(s!==null){let r;if(Array.isArray(s)){r=[];for(let o=0,a=s.length;o<a;o++)s[o].isDataTexture?r.push(Jc(s[o].image)):r.push(Jc(s[o]))}else r=Jc(s);n.url=r}return e||(t.images[this.uuid]=n),n}};function Jc(i){return typeof HTMLImageElement<"u"&&i instanceof HTMLImageElement||typeof HTMLCanvasElement<"u"&&i instanceof HTMLCanvasElement||typeof ImageBitmap<"u"&&i instanceof ImageBitmap?Ra.getDataURL(i):i.data?{data:Array.from(i.data),width:i.width,height:i.height,type:i.data.constructor.name}:(Vt("Texture: Unable to serialize Texture."),{})}var D0=0,jc=new I,un=class i extends Bn{constructor(t=i.DEFAULT_IMAGE,e=i.DEFAULT_MAPPING,n=Yn,s=Yn,r=Ye,o=bi,a=Sn,l=Mn,c=i.DEFAULT_ANISOTROPY,h=Si){super(),this.isTexture=!0,Object.defineProperty(this,"id",{value:D0++}),this.uuid=us(),this.name="",this.source=new Bs(t),this.mipmaps=[],this.mapping=e,this.channel=0,this.wrapS=n,this.wrapT=s,this.magFilter=r,this.minFilter=o,this.anisotropy=c,this.format=a,this.internalFormat=null,this.type=l,this.offset=new rt(0,0),this.repeat=new rt(1,1),this.center=new rt(0,0),this.rotation=0,this.matrixAutoUpdate=!0,this.matrix=new $t,this.generateMipmaps=!0,this.mipmapsAutoUpdate=!0,this.premultiplyAlpha=!1,this.flipY=!0,this.unpackAlignment=4,this.colorSpace=h,this.userData={},this.updateRanges=[],this.version=0,this.onUpdate=null,this.renderTarget=null,this.isRenderTargetTexture=!1,this.isArrayTexture=!!(t&&t.depth&&t.depth>1),this.pmremVersion=0,this.isPMREMTexture=!1,this.normalized=!1}get width(){return this.source.getSize(jc).x}get height(){return this.source.getSize(jc).y}get depth(){return this.source.getSize(jc).z}get image(){return this.source.data}set image(t){this.source.data=t}updateMatrix(){this.matrix.setUvTransform(this.offset.x,this.offset.y,this.repeat.x,this.repeat.y,this.rotation,this.center.x,this.center.y)}addUpdateRange(t,e){this.updateRanges.push({start:t,count:e})}clearUpdateRanges(){this.updateRanges.length=0}clone(){return new this.constructor().copy(this)}copy(t){return this.name=t.name,this.source=t.source,this.mipmaps=t.mipmaps.slice(0),this.mapping=t.mapping,this.channel=t.channel,this.wrapS=t.wrapS,this.wrapT=t.wrapT,this.magFilter=t.magFilter,this.minFilter=t.minFilter,this.anisotropy=t.anisotropy,this.format=t.format,this.internalFormat=t.internalFormat,this.type=t.type,this.normalized=t.normalized,this.offset.copy(t.offset),this.repeat.copy(t.repeat),this.center.copy(t.center),this.rotation=t.rotation,this.matrixAutoUpdate=t.matrixAutoUpdate,this.matrix.copy(t.matrix),this.generateMipmaps=t.generateMipmaps,this.mipmapsAutoUpdate=t.mipmapsAutoUpdate,this.premultiplyAlpha=t.premultiplyAlpha,this.flipY=t.flipY,this.unpackAlignment=t.unpackAlignment,this.colorSpace=t.colorSpace,this.renderTarget=t.renderTarget,this.isRenderTargetTexture=t.isRenderTargetTexture,this.isPMREMTexture=t.isPMREMTexture,this.isArrayTexture=t.isArrayTexture,this.userData=JSON.parse(JSON.stringify(t.userData)),this.needsUpdate=!0,this}setValues(t){for(let e in t){let n=t[e];if(n===void 0){Vt(`Texture.setValues(): parameter '${e}' has value of undefined.`);continue}let s=this[e];if(s===void 0){Vt(`Texture.setValues(): property '${e}' does not exist.`);continue}s&&n&&s.isVector2&&n.isVector2||s&&n&&s.isVector3&&n.isVector3||s&&n&&s.isMatrix3&&n.isMatrix3?s.copy(n):this[e]=n}}toJSON(t){let e=t===void 0||typeof t=="string";if(!e&&t.textures[this.uuid]!==void 0)return t.textures[this.uuid];let n={metadata:{version:4.7,type:"Texture",generator:"Texture.toJSON"},uuid:this.uuid,name:this.name,image:this.source.toJSON(t).uuid,mapping:this.mapping,channel:this.channel,repeat:[this.repeat.x,this.repeat.y],offset:[this.offset.x,this.offset.y],center:[this.center.x,this.center.y],rotation:this.rotation,wrap:[this.wrapS,this.wrapT],format:this.format,internalFormat:this.internalFormat,type:this.type,normalized:this.normalized,colorSpace:this.colorSpace,minFilter:this.minFilter,magFilter:this.magFilter,anisotropy:this.anisotropy,flipY:this.flipY,generateMipmaps:this.generateMipmaps,mipmapsAutoUpdate:this.mipmapsAutoUpdate,premultiplyAlpha:this.premultiplyAlpha,unpackAlignment:this.unpackAlignment};return Object.keys(this.userData).length>0&&(n.userData=this.userData),e||(t.textures[this.uuid]=n),n}dispose(){this.dispatchEvent({type:"dispose"})}transformUv(t){if(this.mapping!==Wh)return t;if(t.applyMatrix3(this.matrix),t.x<0||t.x>1)switch(this.wrapS){case Aa:t.x=t.x-Math.floor(t.x);break;case Yn:t.x=t.x<0?0:1;break;case Ta:Math.abs(Math.floor(t.x)%2)===1?t.x=Math.ceil(t.x)-t.x:t.x=t.x-Math.floor(t.x);break}if(t.y<0||t.y>1)switch(this.wrapT){case Aa:t.y=t.y-Math.floor(t.y);break;case Yn:t.y=t.y<0?0:1;break;case Ta:Math.abs(Math.floor(t.y)%2)===1?t.y=Math.ceil(t.y)-t.y:t.y=t.y-Math.floor(t.y);break}return this.flipY&&(t.y=1-t.y),t}set needsUpdate(t){t===!0&&(this.version++,this.source.needsUpdate=!0)}set needsPMREMUpdate(t){t===!0&&this.pmremVersion++}};un.DEFAULT_IMAGE=null;un.DEFAULT_MAPPING=Wh;un.DEFAULT_ANISOTROPY=1;var Te=class{static{this.prototype.isVector4=!0}constructor(t=0,e=0,n=0,s=1){this.x=t,this.y=e,this.z=n,this.w=s}get width(){return this.z}set width(t){this.z=t}get height(){return this.w}set height(t){this.w=t}set(t,e,n,s){return this.x=t,this.y=e,this.z=n,this.w=s,this}setScalar(t){return this.x=t,this.y=t,this.z=t,this.w=t,this}setX(t){return this.x=t,this}setY(t){return this.y=t,this}setZ(t){return this.z=t,this}setW(t){return this.w=t,this}setComponent(t,e){switch(t){case 0:this.x=e;break;case 1:this.y=e;break;case 2:this.z=e;break;case 3:this.w=e;break;default:throw new Error("THREE.Vector4: index is out of range: "+t)}return this}getComponent(t){switch(t){case 0:return this.x;case 1:return this.y;case 2:return this.z;case 3:return this.w;default:throw new Error("THREE.Vector4: index is out of range: "+t)}}clone(){return new this.constructor(this.x,this.y,this.z,this.w)}copy(t){return this.x=t.x,this.y=t.y,this.z=t.z,this.w=t.w!==void 0?t.w:1,this}add(t){return this.x+=t.x,this.y+=t.y,this.z+=t.z,this.w+=t.w,this}addScalar(t){return this.x+=t,this.y+=t,this.z+=t,this.w+=t,this}addVectors(t,e){return this.x=t.x+e.x,this.y=t.y+e.y,this.z=t.z+e.z,this.w=t.w+e.w,this}addScaledVector(t,e){return this.x+=t.x*e,this.y+=t.y*e,this.z+=t.z*e,this.w+=t.w*e,this}sub(t){return this.x-=t.x,this.y-=t.y,this.z-=t.z,this.w-=t.w,this}subScalar(t){return this.x-=t,this.y-=t,this.z-=t,this.w-=t,this}subVectors(t,e){return this.x=t.x-e.x,this.y=t.y-e.y,this.z=t.z-e.z,this.w=t.w-e.w,this}multiply(t){return this.x*=t.x,this.y*=t.y,this.z*=t.z,this.w*=t.w,this}multiplyScalar(t){return this.x*=t,this.y*=t,this.z*=t,this.w*=t,this}applyMatrix4(t){let e=this.x,n=this.y,s=this.z,r=this.w,o=t.elements;return this.x=o[0]*e+o[4]*n+o[8]*s+o[12]*r,this.y=o[1]*e+o[5]*n+o[9]*s+o[13]*r,this.z=o[2]*e+o[6]*n+o[10]*s+o[14]*r,this.w=o[3]*e+o[7]*n+o[11]*s+o[15]*r,this}divide(t){return this.x/=t.x,this.y/=t.y,this.z/=t.z,this.w/=t.w,this}divideScalar(t){return this.multiplyScalar(1/t)}setAxisAngleFromQuaternion(t){this.w=2*Math.acos(t.w);let e=Math.sqrt(1-t.w*t.w);return e<1e-4?(this.x=1,this.y=0,this.z=0):(this.x=t.x/e,this.y=t.y/e,this.z=t.z/e),this}setAxisAngleFromRotationMatrix(t){let e,n,s,r,l=t.elements,c=l[0],h=l[4],u=l[8],d=l[1],f=l[5],m=l[9],x=l[2],p=l[6],g=l[10];if(Math.abs(h-d)<.01&&Math.abs(u-x)<.01&&Math.abs(m-p)<.01){if(Math.abs(h+d)<.1&&Math.abs(u+x)<.1&&Math.abs(m+p)<.1&&Math.abs(c+f+g-3)<.1)return this.set(1,0,0,0),this;e=Math.PI;let w=(c+1)/2,S=(f+1)/2,T=(g+1)/2,A=(h+d)/4,_=(u+x)/4,E=(m+p)/4;return w>S&&w>T?w<.01?(n=0,s=.707106781,r=.707106781):(n=Math.sqrt(w),s=A/n,r=_/n):S>T?S<.01?(n=.707106781,s=0,r=.707106781):(s=Math.sqrt(S),n=A/s,r=E/s):T<.01?(n=.707106781,s=.707106781,r=0):(r=Math.sqrt(T),n=_/r,s=E/r),this.set(n,s,r,e),this}let y=Math.sqrt((p-m)*(p-m)+(u-x)*(u-x)+(d-h)*(d-h));return Math.abs(y)<.001&&(y=1),this.x=(p-m)/y,this.y=(u-x)/y,this.z=(d-h)/y,this.w=Math.acos((c+f+g-1)/2),this}setFromMatrixPosition(t){let e=t.elements;return this.x=e[12],this.y=e[13],this.z=e[14],this.w=e[15],this}min(t){return this.x=Math.min(this.x,t.x),this.y=Math.min(this.y,t.y),this.z=Math.min(this.z,t.z),this.w=Math.min(this.w,t.w),this}max(t){return this.x=Math.max(this.x,t.x),this.y=Math.max(this.y,t.y),this.z=Math.max(this.z,t.z),this.w=Math.max(this.w,t.w),this}clamp(t,e){return this.x=ee(this.x,t.x,e.x),this.y=ee(this.y,t.y,e.y),this.z=ee(this.z,t.z,e.z),this.w=ee(this.w,t.w,e.w),this}clampScalar(t,e){return this.x=ee(this.x,t,e),this.y=ee(this.y,t,e),this.z=ee(this.z,t,e),this.w=ee(this.w,t,e),this}clampLength(t,e){let n=this.length();return this.divideScalar(n||1).multiplyScalar(ee(n,t,e))}floor(){return this.x=Math.floor(this.x),this.y=Math.floor(this.y),this.z=Math.floor(this.z),this.w=Math.floor(this.w),this}ceil(){return this.x=Math.ceil(this.x),this.y=Math.ceil(this.y),this.z=Math.ceil(this.z),this.w=Math.ceil(this.w),this}round(){return this.x=Math.round(this.x),this.y=Math.round(this.y),this.z=Math.round(this.z),this.w=Math.round(this.w),this}roundToZero(){return this.x=Math.trunc(this.x),this.y=Math.trunc(this.y),this.z=Math.trunc(this.z),this.w=Math.trunc(this.w),this}negate(){return this.x=-this.x,this.y=-this.y,this.z=-this.z,this.w=-this.w,this}dot(t){return this.x*t.x+this.y*t.y+this.z*t.z+this.w*t.w}lengthSq(){return this.x*this.x+this.y*this.y+this.z*this.z+this.w*this.w}length(){return Math.sqrt(this.x*this.x+this.y*this.y+this.z*this.z+this.w*this.w)}manhattanLength(){return Math.abs(this.x)+Math.abs(this.y)+Math.abs(this.z)+Math.abs(this.w)}normalize(){return this.divideScalar(this.length()||1)}setLength(t){return this.normalize().multiplyScalar(t)}lerp(t,e){return this.x+=(t.x-this.x)*e,this.y+=(t.y-this.y)*e,this.z+=(t.z-this.z)*e,this.w+=(t.w-this.w)*e,this}lerpVectors(t,e,n){return this.x=t.x+(e.x-t.x)*n,this.y=t.y+(e.y-t.y)*n,this.z=t.z+(e.z-t.z)*n,this.w=t.w+(e.w-t.w)*n,this}equals(t){return t.x===this.x&&t.y===this.y&&t.z===this.z&&t.w===this.w}fromArray(t,e=0){return this.x=t[e],this.y=t[e+1],this.z=t[e+2],this.w=t[e+3],this}toArray(t=[],e=0){return t[e]=this.x,t[e+1]=this.y,t[e+2]=this.z,t[e+3]=this.w,t}fromBufferAttribute(t,e){return this.x=t.getX(e),this.y=t.getY(e),this.z=t.getZ(e),this.w=t.getW(e),this}random(){return this.x=Math.random(),this.y=Math.random(),this.z=Math.random(),this.w=Math.random(),this}*[Symbol.iterator](){yield this.x,yield this.y,yield this.z,yield this.w}},Pa=class extends Bn{constructor(t=1,e=1,n={}){super(),n=Object.assign({generateMipmaps:!1,internalFormat:null,minFilter:Ye,depthBuffer:!0,stencilBuffer:!1,resolveColorBuffer:!0,resolveDepthBuffer:!0,resolveStencilBuffer:!0,storeMultisampledColorBuffer:!0,storeMultisampledDepthBuffer:!0,storeMultisampledStencilBuffer:!0,depthTexture:null,samples:0,count:1,depth:1,multiview:!1,useArrayDepthTexture:!1},n),this.isRenderTarget=!0,this.width=t,this.height=e,this.depth=n.depth,this.scissor=new Te(0,0,t,e),this.scissorTest=!1,this.viewport=new Te(0,0,t,e),this.textures=[];let s=n.count;for(let r=0;r<s;r++)this.textures[r]=new un({width:t,height:e,depth:n.depth}),this.textures[r].isRenderTargetTexture=!0,this.textures[r].renderTarget=this;this._setTextureOptions(n),this.depthBuffer=n.depthBuffer,this.stencilBuffer=n.stencilBuffer,this.resolveColorBuffer=n.resolveColorBuffer,this.resolveDepthBuffer=n.resolveDepthBuffer,this.resolveStencilBuffer=n.resolveStencilBuffer,this.storeMultisampledColorBuffer=n.storeMultisampledColorBuffer,this.storeMultisampledDepthBuffer=n.storeMultisampledDepthBuffer,this.storeMultisampledStencilBuffer=n.storeMultisampledStencilBuffer,this._depthTexture=null,this.depthTexture=n.depthTexture,this.samples=n.samples,this.multiview=n.multiview,this.useArrayDepthTexture=n.useArrayDepthTexture}_setTextureOptions(t={}){let e={minFilter:Ye,generateMipmaps:!1,flipY:!1,internalFormat:null};t.mapping!==void 0&&(e.mapping=t.mapping),t.wrapS!==void 0&&(e.wrapS=t.wrapS),t.wrapT!==void 0&&(e.wrapT=t.wrapT),t.wrapR!==void 0&&(e.wrapR=t.wrapR),t.magFilter!==void 0&&(e.magFilter=t.magFilter),t.minFilter!==void 0&&(e.minFilter=t.minFilter),t.format!==void 0&&(e.format=t.format),t.type!==void 0&&(e.type=t.type),t.anisotropy!==void 0&&(e.anisotropy=t.anisotropy),t.colorSpace!==void 0&&(e.colorSpace=t.colorSpace),t.flipY!==void 0&&(e.flipY=t.flipY),t.generateMipmaps!==void 0&&(e.generateMipmaps=t.generateMipmaps),t.mipmapsAutoUpdate!==void 0&&(e.mipmapsAutoUpdate=t.mipmapsAutoUpdate),t.internalFormat!==void 0&&(e.internalFormat=t.internalFormat);for(let n=0;n<this.textures.length;n++)this.textures[n].setValues(e)}get texture(){return this.textures[0]}set texture(t){this.textures[0]=t}set depthTexture(t){this._depthTexture!==null&&this._depthTexture.renderTarget===this&&(this._depthTexture.renderTarget=null),t!==null&&t.renderTarget===null&&(t.renderTarget=this),this._depthTexture=t}get depthTexture(){return this._depthTexture}setSize(t,e,n=1){if(this.width!==t||this.height!==e||this.depth!==n){this.width=t,this.height=e,this.depth=n;for(let s=0,r=this.textures.length;s<r;s++)this.textures[s].image.width=t,this.textures[s].image.height=e,this.textures[s].image.depth=n,this.textures[s].isData3DTexture!==!0&&(this.textures[s].isArrayTexture=this.textures[s].image.depth>1);this.dispose()}this.viewport.set(0,0,t,e),this.scissor.set(0,0,t,e)}clone(){return new this.constructor().copy(this)}copy(t){this.width=t.width,this.height=t.height,this.depth=t.depth,this.scissor.copy(t.scissor),this.scissorTest=t.scissorTest,this.viewport.copy(t.viewport),this.textures.length=0;for(let e=0,n=t.textures.length;e<n;e++){this.textures[e]=t.textures[e].clone(),this.textures[e].isRenderTargetTexture=!0,this.textures[e].renderTarget=this;let s=Object.assign({},t.textures[e].image);this.textures[e].source=new Bs(s)}if(this.depthBuffer=t.depthBuffer,this.stencilBuffer=t.stencilBuffer,this.resolveColorBuffer=t.resolveColorBuffer,this.resolveDepthBuffer=t.resolveDepthBuffer,this.resolveStencilBuffer=t.resolveStencilBuffer,this.storeMultisampledColorBuffer=t.storeMultisampledColorBuffer,this.storeMultisampledDepthBuffer=t.storeMultisampledDepthBuffer,this.storeMultisampledStencilBuffer=t.storeMultisampledStencilBuffer,t.depthTexture!==null)if(t.depthTexture.renderTarget===t){let e=t.depthTexture.clone();e.renderTarget=null,this.depthTexture=e}else this.depthTexture=t.depthTexture;else this.depthTexture=null;return this.samples=t.samples,this.multiview=t.multiview,this.useArrayDepthTexture=t.useArrayDepthTexture,this}dispose(){this.dispatchEvent({type:"dispose"})}},Ze=class extends Pa{constructor(t=1,e=1,n={}){super(t,e,n),this.isWebGLRenderTarget=!0}},Ir=class extends un{constructor(t=null,e=1,n=1,s=1){super(null),this.isDataArrayTexture=!0,this.image={data:t,width:e,height:n,depth:s},this.magFilter=Ne,this.minFilter=Ne,this.wrapR=Yn,this.generateMipmaps=!1,this.flipY=!1,this.unpackAlignment=1,this.layerUpdates=new Set}copy(t){return super.copy(t),this.wrapR=t.wrapR,this}addLayerUpdate(t){this.layerUpdates.add(t)}clearLayerUpdates(){this.layerUpdates.clear()}};var Ia=class extends un{constructor(t=null,e=1,n=1,s=1){super(null),this.isData3DTexture=!0,this.image={data:t,width:e,height:n,depth:s},this.magFilter=Ne,this.minFilter=Ne,this.wrapR=Yn,this.generateMipmaps=!1,this.flipY=!1,this.unpackAlignment=1}copy(t){return super.copy(t),this.wrapR=t.wrapR,this}};var ue=class i{static{this.prototype.isMatrix4=!0}constructor(t,e,n,s,r,o,a,l,c,h,u,d,f,m,x,p){this.elements=[1,0,0,0,0,1,0,0,0,0,1,0,0,0,0,1],t!==void 0&&this.set(t,e,n,s,r,o,a,l,c,h,u,d,f,m,x,p)}set(t,e,n,s,r,o,a,l,c,h,u,d,f,m,x,p){let g=this.elements;return g[0]=t,g[4]=e,g[8]=n,g[12]=s,g[1]=r,g[5]=o,g[9]=a,g[13]=l,g[2]=c,g[6]=h,g[10]=u,g[14]=d,g[3]=f,g[7]=m,g[11]=x,g[15]=p,this}identity(){return this.set(1,0,0,0,0,1,0,0,0,0,1,0,0,0,0,1),this}clone(){return new i().fromArray(this.elements)}copy(t){let e=this.elements,n=t.elements;return e[0]=n[0],e[1]=n[1],e[2]=n[2],e[3]=n[3],e[4]=n[4],e[5]=n[5],e[6]=n[6],e[7]=n[7],e[8]=n[8],e[9]=n[9],e[10]=n[10],e[11]=n[11],e[12]=n[12],e[13]=n[13],e[14]=n[14],e[15]=n[15],this}copyPosition(t){let e=this.elements,n=t.elements;return e[12]=n[12],e[13]=n[13],e[14]=n[14],this}setFromMatrix3(t){let e=t.elements;return this.set(e[0],e[3],e[6],0,e[1],e[4],e[7],0,e[2],e[5],e[8],0,0,0,0,1),this}extractBasis(t,e,n){return this.determinantAffine()===0?(t.set(1,0,0),e.set(0,1,0),n.set(0,0,1),this):(t.setFromMatrixColumn(this,0),e.setFromMatrixColumn(this,1),n.setFromMatrixColumn(this,2),this)}makeBasis(t,e,n){return this.set(t.x,e.x,n.x,0,t.y,e.y,n.y,0,t.z,e.z,n.z,0,0,0,0,1),this}extractRotation(t){if(t.determinantAffine()===0)return this.identity();let e=this.elements,n=t.elements,s=1/vs.setFromMatrixColumn(t,0).length(),r=1/vs.setFromMatrixColumn(t,1).length(),o=1/vs.setFromMatrixColumn(t,2).length();return e[0]=n[0]*s,e[1]=n[1]*s,e[2]=n[2]*s,e[3]=0,e[4]=n[4]*r,e[5]=n[5]*r,e[6]=n[6]*r,e[7]=0,e[8]=n[8]*o,e[9]=n[9]*o,e[10]=n[10]*o,e[11]=0,e[12]=0,e[13]=0,e[14]=0,e[15]=1,this}makeRotationFromEuler(t){let e=this.elements,n=t.x,s=t.y,r=t.z,o=Math.cos(n),a=Math.sin(n),l=Math.cos(s),c=Math.sin(s),h=Math.cos(r),u=Math.sin(r);if(t.order==="XYZ"){let d=o*h,f=o*u,m=a*h,x=a*u;e[0]=l*h,e[4]=-l*u,e[8]=c,e[1]=f+m*c,e[5]=d-x*c,e[9]=-a*l,e[2]=x-d*c,e[6]=m+f*c,e[10]=o*l}else if(t.order==="YXZ"){let d=l*h,f=l*u,m=c*h,x=c*u;e[0]=d+x*a,e[4]=m*a-f,e[8]=o*c,e[1]=o*u,e[5]=o*h,e[9]=-a,e[2]=f*a-m,e[6]=x+d*a,e[10]=o*l}else if(t.order==="ZXY"){let d=l*h,f=l*u,m=c*h,x=c*u;e[0]=d-x*a,e[4]=-o*u,e[8]=m+f*a,e[1]=f+m*a,e[5]=o*h,e[9]=x-d*a,e[2]=-o*c,e[6]=a,e[10]=o*l}else if(t.order==="ZYX"){let d=o*h,f=o*u,m=a*h,x=a*u;e[0]=l*h,e[4]=m*c-f,e[8]=d*c+x,e[1]=l*u,e[5]=x*c+d,e[9]=f*c-m,e[2]=-c,e[6]=a*l,e[10]=o*l}else if(t.order==="YZX"){let d=o*l,f=o*c,m=a*l,x=a*c;e[0]=l*h,e[4]=x-d*u,e[8]=m*u+f,e[1]=u,e[5]=o*h,e[9]=-a*h,e[2]=-c*h,e[6]=f*u+m,e[10]=d-x*u}else if(t.order==="XZY"){let d=o*l,f=o*c,m=a*l,x=a*c;e[0]=l*h,e[4]=-u,e[8]=c*h,e[1]=d*u+x,e[5]=o*h,e[9]=f*u-m,e[2]=m*u-f,e[6]=a*h,e[10]=x*u+d}return e[3]=0,e[7]=0,e[11]=0,e[12]=0,e[13]=0,e[14]=0,e[15]=1,this}makeRotationFromQuaternion(t){return this.compose(N0,t,U0)}lookAt(t,e,n){let s=this.elements;return mn.subVectors(t,e),mn.lengthSq()===0&&(mn.z=1),mn.normalize(),Ii.crossVectors(n,mn),Ii.lengthSq()===0&&(Math.abs(n.z)===1?mn.x+=1e-4:mn.z+=1e-4,mn.normalize(),Ii.crossVectors(n,mn)),Ii.normalize(),Vo.crossVectors(mn,Ii),s[0]=Ii.x,s[4]=Vo.x,s[8]=mn.x,s[1]=Ii.y,s[5]=Vo.y,s[9]=mn.y,s[2]=Ii.z,s[6]=Vo.z,s[10]=mn.z,this}multiply(t){return this.multiplyMatrices(this,t)}premultiply(t){return this.multiplyMatrices(t,this)}multiplyMatrices(t,e){let n=t.elements,s=e.elements,r=this.elements,o=n[0],a=n[4],l=n[8],c=n[12],h=n[1],u=n[5],d=n[9],f=n[13],m=n[2],x=n[6],p=n[10],g=n[14],y=n[3],w=n[7],S=n[11],T=n[15],A=s[0],_=s[4],E=s[8],O=s[12],P=s[1],U=s[5],G=s[9],$=s[13],L=s[2],V=s[6],X=s[10],z=s[14],nt=s[3],H=s[7],Q=s[11],et=s[15];return r[0]=o*A+a*P+l*L+c*nt,r[4]=o*_+a*U+l*V+c*H,r[8]=o*E+a*G+l*X+c*Q,r[12]=o*O+a*$+l*z+c*et,r[1]=h*A+u*P+d*L+f*nt,r[5]=h*_+u*U+d*V+f*H,r[9]=h*E+u*G+d*X+f*Q,r[13]=h*O+u*$+d*z+f*et,r[2]=m*A+x*P+p*L+g*nt,r[6]=m*_+x*U+p*V+g*H,r[10]=m*E+x*G+p*X+g*Q,r[14]=m*O+x*$+p*z+g*et,r[3]=y*A+w*P+S*L+T*nt,r[7]=y*_+w*U+S*V+T*H,r[11]=y*E+w*G+S*X+T*Q,r[15]=y*O+w*$+S*z+T*et,this}multiplyScalar(t){let e=this.elements;return e[0]*=t,e[4]*=t,e[8]*=t,e[12]*=t,e[1]*=t,e[5]*=t,e[9]*=t,e[13]*=t,e[2]*=t,e[6]*=t,e[10]*=t,e[14]*=t,e[3]*=t,e[7]*=t,e[11]*=t,e[15]*=t,this}determinant(){let t=this.elements,e=t[0],n=t[4],s=t[8],r=t[12],o=t[1],a=t[5],l=t[9],c=t[13],h=t[2],u=t[6],d=t[10],f=t[14],m=t[3],x=t[7],p=t[11],g=t[15],y=l*f-c*d,w=a*f-c*u,S=a*d-l*u,T=o*f-c*h,A=o*d-l*h,_=o*u-a*h;return e*(x*y-p*w+g*S)-n*(m*y-p*T+g*A)+s*(m*w-x*T+g*_)-r*(m*S-x*A+p*_)}determinantAffine(){let t=this.elements,e=t[0],n=t[4],s=t[8],r=t[1],o=t[5],a=t[9],l=t[2],c=t[6],h=t[10];return e*(o*h-a*c)-n*(r*h-a*l)+s*(r*c-o*l)}transpose(){let t=this.elements,e;return e=t[1],t[1]=t[4],t[4]=e,e=t[2],t[2]=t[8],t[8]=e,e=t[6],t[6]=t[9],t[9]=e,e=t[3],t[3]=t[12],t[12]=e,e=t[7],t[7]=t[13],t[13]=e,e=t[11],t[11]=t[14],t[14]=e,this}setPosition(t,e,n){let s=this.elements;return t.isVector3?(s[12]=t.x,s[13]=t.y,s[14]=t.z):(s[12]=t,s[13]=e,s[14]=n),this}invert(){let t=this.elements,e=t[0],n=t[1],s=t[2],r=t[3],o=t[4],a=t[5],l=t[6],c=t[7],h=t[8],u=t[9],d=t[10],f=t[11],m=t[12],x=t[13],p=t[14],g=t[15],y=e*a-n*o,w=e*l-s*o,S=e*c-r*o,T=n*l-s*a,A=n*c-r*a,_=s*c-r*l,E=h*x-u*m,O=h*p-d*m,P=h*g-f*m,U=u*p-d*x,G=u*g-f*x,$=d*g-f*p,L=y*$-w*G+S*U+T*P-A*O+_*E;if(L===0)return this.set(0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0);let V=1/L;return t[0]=(a*$-l*G+c*U)*V,t[1]=(s*G-n*$-r*U)*V,t[2]=(x*_-p*A+g*T)*V,t[3]=(d*A-u*_-f*T)*V,t[4]=(l*P-o*$-c*O)*V,t[5]=(e*$-s*P+r*O)*V,t[6]=(p*S-m*_-g*w)*V,t[7]=(h*_-d*S+f*w)*V,t[8]=(o*G-a*P+c*E)*V,t[9]=(n*P-e*G-r*E)*V,t[10]=(m*A-x*S+g*y)*V,t[11]=(u*S-h*A-f*y)*V,t[12]=(a*O-o*U-l*E)*V,t[13]=(e*U-n*O+s*E)*V,t[14]=(x*w-m*T-p*y)*V,t[15]=(h*T-u*w+d*y)*V,this}scale(t){let e=this.elements,n=t.x,s=t.y,r=t.z;return e[0]*=n,e[4]*=s,e[8]*=r,e[1]*=n,e[5]*=s,e[9]*=r,e[2]*=n,e[6]*=s,e[10]*=r,e[3]*=n,e[7]*=s,e[11]*=r,this}getMaxScaleOnAxis(){let t=this.elements,e=t[0]*t[0]+t[1]*t[1]+t[2]*t[2],n=t[4]*t[4]+t[5]*t[5]+t[6]*t[6],s=t[8]*t[8]+t[9]*t[9]+t[10]*t[10];return Math.sqrt(Math.max(e,n,s))}makeTranslation(t,e,n){return t.isVector3?this.set(1,0,0,t.x,0,1,0,t.y,0,0,1,t.z,0,0,0,1):this.set(1,0,0,t,0,1,0,e,0,0,1,n,0,0,0,1),this}makeRotationX(t){let e=Math.cos(t),n=Math.sin(t);return this.set(1,0,0,0,0,e,-n,0,0,n,e,0,0,0,0,1),this}makeRotationY(t){let e=Math.cos(t),n=Math.sin(t);return this.set(e,0,n,0,0,1,0,0,-n,0,e,0,0,0,0,1),this}makeRotationZ(t){let e=Math.cos(t),n=Math.sin(t);return this.set(e,-n,0,0,n,e,0,0,0,0,1,0,0,0,0,1),this}makeRotationAxis(t,e){let n=Math.cos(e),s=Math.sin(e),r=1-n,o=t.x,a=t.y,l=t.z,c=r*o,h=r*a;return this.set(c*o+n,c*a-s*l,c*l+s*a,0,c*a+s*l,h*a+n,h*l-s*o,0,c*l-s*a,h*l+s*o,r*l*l+n,0,0,0,0,1),this}makeScale(t,e,n){return this.set(t,0,0,0,0,e,0,0,0,0,n,0,0,0,0,1),this}makeShear(t,e,n,s,r,o){return this.set(1,n,r,0,t,1,o,0,e,s,1,0,0,0,0,1),this}compose(t,e,n){let s=this.elements,r=e._x,o=e._y,a=e._z,l=e._w,c=r+r,h=o+o,u=a+a,d=r*c,f=r*h,m=r*u,x=o*h,p=o*u,g=a*u,y=l*c,w=l*h,S=l*u,T=n.x,A=n.y,_=n.z;return s[0]=(1-(x+g))*T,s[1]=(f+S)*T,s[2]=(m-w)*T,s[3]=0,s[4]=(f-S)*A,s[5]=(1-(d+g))*A,s[6]=(p+y)*A,s[7]=0,s[8]=(m+w)*_,s[9]=(p-y)*_,s[10]=(1-(d+x))*_,s[11]=0,s[12]=t.x,s[13]=t.y,s[14]=t.z,s[15]=1,this}decompose(t,e,n){let s=this.elements;t.x=s[12],t.y=s[13],t.z=s[14];let r=this.determinantAffine();if(r===0)return n.set(1,1,1),e.identity(),this;let o=vs.set(s[0],s[1],s[2]).length(),a=vs.set(s[4],s[5],s[6]).length(),l=vs.set(s[8],s[9],s[10]).length();r<0&&(o=-o),Un.copy(this);let c=1/o,h=1/a,u=1/l;return Un.elements[0]*=c,Un.elements[1]*=c,Un.elements[2]*=c,Un.elements[4]*=h,Un.elements[5]*=h,Un.elements[6]*=h,Un.elements[8]*=u,Un.elements[9]*=u,Un.elements[10]*=u,e.setFromRotationMatrix(Un),n.x=o,n.y=a,n.z=l,this}makePerspective(t,e,n,s,r,o,a=Cn,l=!1){let c=this.elements,h=2*r/(e-t),u=2*r/(n-s),d=(e+t)/(e-t),f=(n+s)/(n-s),m,x;if(l)m=r/(o-r),x=o*r/(o-r);else if(a===Cn)m=-(o+r)/(o-r),x=-2*o*r/(o-r);else if(a===Rr)m=-o/(o-r),x=-o*r/(o-r);else throw new Error("THREE.Matrix4.makePerspective(): Invalid coordinate system: "+a);return c[0]=h,c[4]=0,c[8]=d,c[12]=0,c[1]=0,c[5]=u,c[9]=f,c[13]=0,c[2]=0,c[6]=0,c[10]=m,c[14]=x,c[3]=0,c[7]=0,c[11]=-1,c[15]=0,this}makeOrthographic(t,e,n,s,r,o,a=Cn,l=!1){let c=this.elements,h=2/(e-t),u=2/(n-s),d=-(e+t)/(e-t),f=-(n+s)/(n-s),m,x;if(l)m=1/(o-r),x=o/(o-r);else if(a===Cn)m=-2/(o-r),x=-(o+r)/(o-r);else if(a===Rr)m=-1/(o-r),x=-r/(o-r);else throw new Error("THREE.Matrix4.makeOrthographic(): Invalid coordinate system: "+a);return c[0]=h,c[4]=0,c[8]=0,c[12]=d,c[1]=0,c[5]=u,c[9]=0,c[13]=f,c[2]=0,c[6]=0,c[10]=m,c[14]=x,c[3]=0,c[7]=0,c[11]=0,c[15]=1,this}equals(t){let e=this.elements,n=t.elements;for(let s=0;s<16;s++)if(e[s]!==n[s])return!1;return!0}fromArray(t,e=0){for(let n=0;n<16;n++)this.elements[n]=t[n+e];return this}toArray(t=[],e=0){let n=this.elements;return t[e]=n[0],t[e+1]=n[1],t[e+2]=n[2],t[e+3]=n[3],t[e+4]=n[4],t[e+5]=n[5],t[e+6]=n[6],t[e+7]=n[7],t[e+8]=n[8],t[e+9]=n[9],t[e+10]=n[10],t[e+11]=n[11],t[e+12]=n[12],t[e+13]=n[13],t[e+14]=n[14],t[e+15]=n[15],t}},vs=new I,Un=new ue,N0=new I(0,0,0),U0=new I(1,1,1),Ii=new I,Vo=new I,mn=new I,Kd=new ue,Qd=new Ue,Oi=class i{constructor(t=0,e=0,n=0,s=i.DEFAULT_ORDER){this.isEuler=!0,this._x=t,this._y=e,this._z=n,this._order=s}get x(){return this._x}set x(t){this._x=t,this._onChangeCallback()}get y(){return this._y}set y(t){this._y=t,this._onChangeCallback()}get z(){return this._z}set z(t){this._z=t,this._onChangeCallback()}get order(){return this._order}set order(t){this._order=t,this._onChangeCallback()}set(t,e,n,s=this._order){return this._x=t,this._y=e,this._z=n,this._order=s,this._onChangeCallback(),this}clone(){return new this.constructor(this._x,this._y,this._z,this._order)}copy(t){return this._x=t._x,this._y=t._y,this._z=t._z,this._order=t._order,this._onChangeCallback(),this}setFromRotationMatrix(t,e=this._order,n=!0){let s=t.elements,r=s[0],o=s[4],a=s[8],l=s[1],c=s[5],h=s[9],u=s[2],d=s[6],f=s[10];switch(e){case"XYZ":this._y=Math.asin(ee(a,-1,1)),Math.abs(a)<.9999999?(this._x=Math.atan2(-h,f),this._z=Math.atan2(-o,r)):(this._x=Math.atan2(d,c),this._z=0);break;case"YXZ":this._x=Math.asin(-ee(h,-1,1)),Math.abs(h)<.9999999?(this._y=Math.atan2(a,f),this._z=Math.atan2(l,c)):(this._y=Math.atan2(-u,r),this._z=0);break;case"ZXY":this._x=Math.asin(ee(d,-1,1)),Math.abs(d)<.9999999?(this._y=Math.atan2(-u,f),this._z=Math.atan2(-o,c)):(this._y=0,this._z=Math.atan2(l,r));break;case"ZYX":this._y=Math.asin(-ee(u,-1,1)),Math.abs(u)<.9999999?(this._x=Math.atan2(d,f),this._z=Math.atan2(l,r)):(this._x=0,this._z=Math.atan2(-o,c));break;case"YZX":this._z=Math.asin(ee(l,-1,1)),Math.abs(l)<.9999999?(this._x=Math.atan2(-h,c),this._y=Math.atan2(-u,r)):(this._x=0,this._y=Math.atan2(a,f));break;case"XZY":this._z=Math.asin(-ee(o,-1,1)),Math.abs(o)<.9999999?(this._x=Math.atan2(d,c),this._y=Math.atan2(a,r)):(this._x=Math.atan2(-h,f),this._y=0);break;default:Vt("Euler: .setFromRotationMatrix() encountered an unknown order: "+e)}return this._order=e,n===!0&&this._onChangeCallback(),this}setFromQuaternion(t,e,n){return Kd.makeRotationFromQuaternion(t),this.setFromRotationMatrix(Kd,e,n)}setFromVector3(t,e=this._order){return this.set(t.x,t.y,t.z,e)}reorder(t){return Qd.setFromEuler(this),this.setFromQuaternion(Qd,t)}equals(t){return t._x===this._x&&t._y===this._y&&t._z===this._z&&t._order===this._order}fromArray(t){return this._x=t[0],this._y=t[1],this._z=t[2],t[3]!==void 0&&(this._order=t[3]),this._onChangeCallback(),this}toArray(t=[],e=0){return t[e]=this._x,t[e+1]=this._y,t[e+2]=this._z,t[e+3]=this._order,t}_onChange(t){return this._onChangeCallback=t,this}_onChangeCallback(){}*[Symbol.iterator](){yield this._x,yield this._y,yield this._z,yield this._order}};Oi.DEFAULT_ORDER="XYZ";var ks=class{constructor(){this.mask=1}set(t){this.mask=(1<<t|0)>>>0}enable(t){this.mask|=1<<t|0}enableAll(){this.mask=-1}toggle(t){this.mask^=1<<t|0}disable(t){this.mask&=~(1<<t|0)}disableAll(){this.mask=0}test(t){return(this.mask&t.mask)!==0}isEnabled(t){return(this.mask&(1<<t|0))!==0}},O0=0,tf=new I,ys=new Ue,ci=new ue,Ho=new I,mr=new I,F0=new I,B0=new Ue,ef=new I(1,0,0),nf=new I(0,1,0),sf=new I(0,0,1),rf={type:"added"},k0={type:"removed"},bs={type:"childadded",child:null},Kc={type:"childremoved",child:null},dn=class i extends Bn{constructor(){super(),this.isObject3D=!0,Object.defineProperty(this,"id",{value:O0++}),this.uuid=us(),this.name="",this.type="Object3D",this.parent=null,this.children=[],this.up=i.DEFAULT_UP.clone();let t=new I,e=new Oi,n=new Ue,s=new I(1,1,1);function r(){n.setFromEuler(e,!1)}function o(){e.setFromQuaternion(n,void 0,!1)}e._onChange(r),n._onChange(o),Object.defineProperties(this,{position:{configurable:!0,enumerable:!0,value:t},rotation:{configurable:!0,enumerable:!0,value:e},quaternion:{configurable:!0,enumerable:!0,value:n},scale:{configurable:!0,enumerable:!0,value:s},modelViewMatrix:{value:new ue},normalMatrix:{value:new $t}}),this.matrix=new ue,this.matrixWorld=new ue,this.matrixAutoUpdate=i.DEFAULT_MATRIX_AUTO_UPDATE,this.matrixWorldAutoUpdate=i.DEFAULT_MATRIX_WORLD_AUTO_UPDATE,this.matrixWorldNeedsUpdate=!1,this.layers=new ks,this.visible=!0,this.castShadow=!1,this.receiveShadow=!1,this.frustumCulled=!0,this.renderOrder=0,this.animations=[],this.customDepthMaterial=void 0,this.customDistanceMaterial=void 0,this.static=!1,this.userData={},this.pivot=null}onBeforeShadow(){}onAfterShadow(){}onBeforeRender(){}onAfterRender(){}applyMatrix4(t){this.matrixAutoUpdate&&this.updateMatrix(),this.matrix.premultiply(t),this.matrix.decompose(this.position,this.quaternion,this.scale),this.pivot!==null&&this.position.copy(this.pivot).applyMatrix4(this.matrix).sub(this.pivot)}applyQuaternion(t){return this.quaternion.premultiply(t),this}setRotationFromAxisAngle(t,e){this.quaternion.setFromAxisAngle(t,e)}setRotationFromEuler(t){this.quaternion.setFromEuler(t,!0)}setRotationFromMatrix(t){this.quaternion.setFromRotationMatrix(t)}setRotationFromQuaternion(t){this.quaternion.copy(t)}rotateOnAxis(t,e){return ys.setFromAxisAngle(t,e),this.quaternion.multiply(ys),this}rotateOnWorldAxis(t,e){return ys.setFromAxisAngle(t,e),this.quaternion.premultiply(ys),this}rotateX(t){return this.rotateOnAxis(ef,t)}rotateY(t){return this.rotateOnAxis(nf,t)}rotateZ(t){return this.rotateOnAxis(sf,t)}translateOnAxis(t,e){return tf.copy(t).applyQuaternion(this.quaternion),this.position.add(tf.multiplyScalar(e)),this}translateX(t){return this.translateOnAxis(ef,t)}translateY(t){return this.translateOnAxis(nf,t)}translateZ(t){return this.translateOnAxis(sf,t)}localToWorld(t){return this.updateWorldMatrix(!0,!1),t.applyMatrix4(this.matrixWorld)}worldToLocal(t){return this.updateWorldMatrix(!0,!1),t.applyMatrix4(ci.copy(this.matrixWorld).invert())}lookAt(t,e,n){t.isVector3?Ho.copy(t):Ho.set(t,e,n);let s=this.parent;this.updateWorldMatrix(!0,!1),mr.setFromMatrixPosition(this.matrixWorld),this.isCamera||this.isLight?ci.lookAt(mr,Ho,this.up):ci.lookAt(Ho,mr,this.up),this.quaternion.setFromRotationMatrix(ci),s&&(ci.extractRotation(s.matrixWorld),ys.setFromRotationMatrix(ci),this.quaternion.premultiply(ys.invert()))}add(t){if(arguments.length>1){for(let e=0;e<arguments.length;e++)this.add(arguments[e]);return this}return t===this?(Wt("Object3D.add: object can't be added as a child of itself.",t),this):(t&&t.isObject3D?(t.removeFromParent(),t.parent=this,this.children.push(t),t.dispatchEvent(rf),bs.child=t,this.dispatchEvent(bs),bs.child=null):Wt("Object3D.add: object not an instance of THREE.Object3D.",t),this)}remove(t){if(arguments.length>1){for(let n=0;n<arguments.length;n++)this.remove(arguments[n]);return this}let e=this.children.indexOf(t);return e!==-1&&(t.parent=null,this.children.splice(e,1),t.dispatchEvent(k0),Kc.child=t,this.dispatchEvent(Kc),Kc.child=null),this}removeFromParent(){let t=this.parent;return t!==null&&t.remove(this),this}clear(){return this.remove(...this.children)}attach(t){return this.updateWorldMatrix(!0,!1),ci.copy(this.matrixWorld).invert(),t.parent!==null&&(t.parent.updateWorldMatrix(!0,!1),ci.multiply(t.parent.matrixWorld)),t.applyMatrix4(ci),t.removeFromParent(),t.parent=this,this.children.push(t),t.updateWorldMatrix(!1,!0),t.dispatchEvent(rf),bs.child=t,this.dispatchEvent(bs),bs.child=null,this}getObjectById(t){return this.getObjectByProperty("id",t)}getObjectByName(t){return this.getObjectByProperty("name",t)}getObjectByProperty(t,e){if(this[t]===e)return this;for(let n=0,s=this.children.length;n<s;n++){let o=this.children[n].getObjectByProperty(t,e);if(o!==void 0)return o}}getObjectsByProperty(t,e,n=[]){this[t]===e&&n.push(this);let s=this.children;for(let r=0,o=s.length;r<o;r++)s[r].getObjectsByProperty(t,e,n);return n}getWorldPosition(t){return this.updateWorldMatrix(!0,!1),t.setFromMatrixPosition(this.matrixWorld)}getWorldQuaternion(t){return this.updateWorldMatrix(!0,!1),this.matrixWorld.decompose(mr,t,F0),t}getWorldScale(t){return this.updateWorldMatrix(!0,!1),this.matrixWorld.decompose(mr,B0,t),t}getWorldDirection(t){this.updateWorldMatrix(!0,!1);let e=this.matrixWorld.elements;return t.set(e[8],e[9],e[10]).normalize()}raycast(){}intersectsFrustum(){return!0}traverse(t){t(this);let e=this.children;for(let n=0,s=e.length;n<s;n++)e[n].traverse(t)}traverseVisible(t){if(this.visible===!1)return;t(this);let e=this.children;for(let n=0,s=e.length;n<s;n++)e[n].traverseVisible(t)}traverseAncestors(t){let e=this.parent;e!==null&&(t(e),e.traverseAncestors(t))}updateMatrix(){this.matrix.compose(this.position,this.quaternion,this.scale);let t=this.pivot;if(t!==null){let e=t.x,n=t.y,s=t.z,r=this.matrix.elements;r[12]+=e-r[0]*e-r[4]*n-r[8]*s,r[13]+=n-r[1]*e-r[5]*n-r[9]*s,r[14]+=s-r[2]*e-r[6]*n-r[10]*s}this.matrixWorldNeedsUpdate=!0}updateMatrixWorld(t){this.matrixAutoUpdate&&this.updateMatrix(),(this.matrixWorldNeedsUpdate||t)&&(this.matrixWorldAutoUpdate===!0&&(this.parent===null?this.matrixWorld.copy(this.matrix):this.matrixWorld.multiplyMatrices(this.parent.matrixWorld,this.matrix)),this.matrixWorldNeedsUpdate=!1,t=!0);let e=this.children;for(let n=0,s=e.length;n<s;n++)e[n].updateMatrixWorld(t)}updateWorldMatrix(t,e,n=!1){let s=this.parent;if(t===!0&&s!==null&&s.updateWorldMatrix(!0,!1),this.matrixAutoUpdate&&this.updateMatrix(),(this.matrixWorldNeedsUpdate||n)&&(this.matrixWorldAutoUpdate===!0&&(this.parent===null?this.matrixWorld.copy(this.matrix):this.matrixWorld.multiplyMatrices(this.parent.matrixWorld,this.matrix)),this.matrixWorldNeedsUpdate=!1,n=!0),e===!0){let r=this.children;for(let o=0,a=r.length;o<a;o++)r[o].updateWorldMatrix(!1,!0,n)}}toJSON(t){let e=t===void 0||typeof t=="string",n={};e&&(t={geometries:{},materials:{},textures:{},images:{},shapes:{},skeletons:{},animations:{},nodes:{}},n.metadata={version:4.7,type:"Object",generator:"Object3D.toJSON"});let s={};s.uuid=this.uuid,s.type=this.type,s.name=this.name,s.castShadow=this.castShadow,s.receiveShadow=this.receiveShadow,s.visible=this.visible,s.frustumCulled=this.frustumCulled,s.renderOrder=this.renderOrder,s.static=this.static,s.matrixAutoUpdate=this.matrixAutoUpdate,Object.keys(this.userData).length>0&&(s.userData=this.userData),s.layers=this.layers.mask,s.matrix=this.matrix.toArray(),s.up=this.up.toArray(),this.pivot!==null&&(s.pivot=this.pivot.toArray()),this.morphTargetDictionary!==void 0&&(s.morphTargetDictionary=Object.assign({},this.morphTargetDictionary)),this.morphTargetInfluences!==void 0&&(s.morphTargetInfluences=this.morphTargetInfluences.slice()),this.isInstancedMesh&&(s.type="InstancedMesh",s.count=this.count,s.instanceMatrix=this.instanceMatrix.toJSON(),this.instanceColor!==null&&(s.instanceColor=this.instanceColor.toJSON())),this.isBatchedMesh&&(s.type="BatchedMesh",s.perObjectFrustumCulled=this.perObjectFrustumCulled,s.sortObjects=this.sortObjects,s.drawRanges=this._drawRanges,s.reservedRanges=this._reservedRanges,s.geometryInfo=this._geometryInfo.map(a=>({...a,boundingBox:a.boundingBox?a.boundingBox.toJSON():void 0,boundingSphere:a.boundingSphere?a.boundingSphere.toJSON():void 0})),s.instanceInfo=this._instanceInfo.map(a=>({...a})),s.availableInstanceIds=this._availableInstanceIds.slice(),s.availableGeometryIds=this._availableGeometryIds.slice(),s.nextIndexStart=this._nextIndexStart,s.nextVertexStart=this._nextVertexStart,s.geometryCount=this._geometryCount,s.maxInstanceCount=this._maxInstanceCount,s.maxVertexCount=this._maxVertexCount,s.maxIndexCount=this._maxIndexCount,s.geometryInitialized=this._geometryInitialized,s.matricesTexture=this._matricesTexture.toJSON(t),s.indirectTexture=this._indirectTexture.toJSON(t),this._colorsTexture!==null&&(s.colorsTexture=this._colorsTexture.toJSON(t)),this.boundingSphere!==null&&(s.boundingSphere=this.boundingSphere.toJSON()),this.boundingBox!==null&&(s.boundingBox=this.boundingBox.toJSON()));function r(a,l){return a[l.uuid]===void 0&&(a[l.uuid]=l.toJSON(t)),l.uuid}if(this.isScene)this.background&&(this.background.isColor?s.background=this.background.toJSON():this.background.isTexture&&(s.background=this.background.toJSON(t).uuid)),this.environment&&this.environment.isTexture&&this.environment.isRenderTargetTexture!==!0&&(s.environment=this.environment.toJSON(t).uuid);else if(this.isMesh||this.isLine||this.isPoints){s.geometry=r(t.geometries,this.geometry);let a=this.geometry.parameters;if(a!==void 0&&a.shapes!==void 0){let l=a.shapes;if(Array.isArray(l))for(let c=0,h=l.length;c<h;c++){let u=l[c];r(t.shapes,u)}else r(t.shapes,l)}}if(this.isSkinnedMesh&&(s.bindMode=this.bindMode,s.bindMatrix=this.bindMatrix.toArray(),this.skeleton!==void 0&&(r(t.skeletons,this.skeleton),s.skeleton=this.skeleton.uuid)),this.material!==void 0)if(Array.isArray(this.material)){let a=[];for(let l=0,c=this.material.length;l<c;l++)a.push(r(t.materials,this.material[l]));s.material=a}else s.material=r(t.materials,this.material);if(this.children.length>0){s.children=[];for(let a=0;a<this.children.length;a++)s.children.push(this.children[a].toJSON(t).object)}if(this.animations.length>0){s.animations=[];for(let a=0;a<this.animations.length;a++){let l=this.animations[a];s.animations.push(r(t.animations,l))}}if(e){let a=o(t.geometries),l=o(t.materials),c=o(t.textures),h=o(t.images),u=o(t.shapes),d=o(t.skeletons),f=o(t.animations),m=o(t.nodes);a.length>0&&(n.geometries=a),l.length>0&&(n.materials=l),c.length>0&&(n.textures=c),h.length>0&&(n.images=h),u.length>0&&(n.shapes=u),d.length>0&&(n.skeletons=d),f.length>0&&(n.animations=f),m.length>0&&(n.nodes=m)}return n.object=s,n;function o(a){let l=[];for(let c in a){let h=a[c];delete h.metadata,l.push(h)}return l}}clone(t){return new this.constructor().copy(this,t)}copy(t,e=!0){if(this.name=t.name,this.up.copy(t.up),this.position.copy(t.position),this.rotation.order=t.rotation.order,this.quaternion.copy(t.quaternion),this.scale.copy(t.scale),this.pivot=t.pivot!==null?t.pivot.clone():null,this.matrix.copy(t.matrix),this.matrixWorld.copy(t.matrixWorld),this.matrixAutoUpdate=t.matrixAutoUpdate,this.matrixWorldAutoUpdate=t.matrixWorldAutoUpdate,this.matrixWorldNeedsUpdate=t.matrixWorldNeedsUpdate,this.layers.mask=t.layers.mask,this.visible=t.visible,this.castShadow=t.castShadow,this.receiveShadow=t.receiveShadow,this.frustumCulled=t.frustumCulled,this.renderOrder=t.renderOrder,this.static=t.static,this.animations=t.animations.slice(),this.userData=JSON.parse(JSON.stringify(t.userData)),e===!0)for(let n=0;n<t.children.length;n++){let s=t.children[n];this.add(s.clone())}return this}dispose(){this.dispatchEvent({type:"dispose"})}};dn.DEFAULT_UP=new I(0,1,0);dn.DEFAULT_MATRIX_AUTO_UPDATE=!0;dn.DEFAULT_MATRIX_WORLD_AUTO_UPDATE=!0;var De=class extends dn{constructor(){super(),this.isGroup=!0,this.type="Group"}},z0={type:"move"},zs=class{constructor(){this._targetRay=null,this._grip=null,this._hand=null}getHandSpace(){return this._hand===null&&(this._hand=new De,this._hand.matrixAutoUpdate=!1,this._hand.visible=!1,this._hand.joints={},this._hand.inputState={pinching:!1}),this._hand}getTargetRaySpace(){return this._targetRay===null&&(this._targetRay=new De,this._targetRay.matrixAutoUpdate=!1,this._targetRay.visible=!1,this._targetRay.hasLinearVelocity=!1,this._targetRay.linearVelocity=new I,this._targetRay.hasAngularVelocity=!1,this._targetRay.angularVelocity=new I),this._targetRay}getGripSpace(){return this._grip===null&&(this._grip=new De,this._grip.matrixAutoUpdate=!1,this._grip.visible=!1,this._grip.hasLinearVelocity=!1,this._grip.linearVelocity=new I,this._grip.hasAngularVelocity=!1,this._grip.angularVelocity=new I,this._grip.eventsEnabled=!1),this._grip}dispatchEvent(t){return this._targetRay!==null&&this._targetRay.dispatchEvent(t),this._grip!==null&&this._grip.dispatchEvent(t),this._hand!==null&&this._hand.dispatchEvent(t),this}connect(t){if(t&&t.hand){let e=this._hand;if(e)for(let n of t.hand.values())this._getHandJoint(e,n)}return this.dispatchEvent({type:"connected",data:t}),this}disconnect(t){return this.dispatchEvent({type:"disconnected",data:t}),this._targetRay!==null&&(this._targetRay.visible=!1),this._grip!==null&&(this._grip.visible=!1),this._hand!==null&&(this._hand.visible=!1),this}update(t,e,n){let s=null,r=null,o=null,a=this._targetRay,l=this._grip,c=this._hand;if(t&&e.session.visibilityState!=="visible-blurred"){if(c&&t.hand){o=!0;for(let x of t.hand.values()){let p=e.getJointPose(x,n),g=this._getHandJoint(c,x);p!==null&&(g.matrix.fromArray(p.transform.matrix),g.matrix.decompose(g.position,g.quaternion,g.scale),g.matrixWorldNeedsUpdate=!0,g.jointRadius=p.radius),g.visible=p!==null}let h=c.joints["index-finger-tip"],u=c.joints["thumb-tip"],d=h.position.distanceTo(u.position),f=.02,m=.005;c.inputState.pinching&&d>f+m?(c.inputState.pinching=!1,this.dispatchEvent({type:"pinchend",handedness:t.handedness,target:this})):!c.inputState.pinching&&d<=f-m&&(c.inputState.pinching=!0,this.dispatchEvent({type:"pinchstart",handedness:t.handedness,target:this}))}else l!==null&&t.gripSpace&&(r=e.getPose(t.gripSpace,n),r!==null&&(l.matrix.fromArray(r.transform.matrix),l.matrix.decompose(l.position,l.quaternion,l.scale),l.matrixWorldNeedsUpdate=!0,r.linearVelocity?(l.hasLinearVelocity=!0,l.linearVelocity.copy(r.linearVelocity)):l.hasLinearVelocity=!1,r.angularVelocity?(l.hasAngularVelocity=!0,l.angularVelocity.copy(r.angularVelocity)):l.hasAngularVelocity=!1,l.eventsEnabled&&l.dispatchEvent({type:"gripUpdated",data:t,target:this})));a!==null&&(s=e.getPose(t.targetRaySpace,n),s===null&&r!==null&&(s=r),s!==null&&(a.matrix.fromArray(s.transform.matrix),a.matrix.decompose(a.position,a.quaternion,a.scale),a.matrixWorldNeedsUpdate=!0,s.linearVelocity?(a.hasLinearVelocity=!0,a.linearVelocity.copy(s.linearVelocity)):a.hasLinearVelocity=!1,s.angularVelocity?(a.hasAngularVelocity=!0,a.angularVelocity.copy(s.angularVelocity)):a.hasAngularVelocity=!1,this.dispatchEvent(z0)))}return a!==null&&(a.visible=s!==null),l!==null&&(l.visible=r!==null),c!==null&&(c.visible=o!==null),this}_getHandJoint(t,e){if(t.joints[e.jointName]===void 0){let n=new De;n.matrixAutoUpdate=!1,n.visible=!1,t.joints[e.jointName]=n,t.add(n)}return t.joints[e.jointName]}},fp={aliceblue:15792383,antiquewhite:16444375,aqua:65535,aquamarine:8388564,azure:15794175,beige:16119260,bisque:16770244,black:0,blanchedalmond:16772045,blue:255,blueviolet:9055202,brown:10824234,burlywood:14596231,cadetblue:6266528,chartreuse:8388352,chocolate:13789470,coral:16744272,cornflowerblue:6591981,cornsilk:16775388,crimson:14423100,cyan:65535,darkblue:139,darkcyan:35723,darkgoldenrod:12092939,darkgray:11119017,darkgreen:25600,darkgrey:11119017,darkkhaki:12433259,darkmagenta:9109643,darkolivegreen:5597999,darkorange:16747520,darkorchid:10040012,darkred:9109504,darksalmon:15308410,darkseagreen:9419919,darkslateblue:4734347,darkslategray:3100495,darkslategrey:3100495,darkturquoise:52945,darkviolet:9699539,deeppink:16716947,deepskyblue:49151,dimgray:6908265,dimgrey:6908265,dodgerblue:2003199,firebrick:11674146,floralwhite:16775920,forestgreen:2263842,fuchsia:16711935,gainsboro:14474460,ghostwhite:16316671,gold:16766720,goldenrod:14329120,gray:8421504,green:32768,greenyellow:11403055,grey:8421504,honeydew:15794160,hotpink:16738740,indianred:13458524,indigo:4915330,ivory:16777200,khaki:15787660,lavender:15132410,lavenderblush:16773365,lawngreen:8190976,lemonchiffon:16775885,lightblue:11393254,lightcoral:15761536,lightcyan:14745599,lightgoldenrodyellow:16448210,lightgray:13882323,lightgreen:9498256,lightgrey:13882323,lightpink:16758465,lightsalmon:16752762,lightseagreen:2142890,lightskyblue:8900346,lightslategray:7833753,lightslategrey:7833753,lightsteelblue:11584734,lightyellow:16777184,lime:65280,limegreen:3329330,linen:16445670,magenta:16711935,maroon:8388608,mediumaquamarine:6737322,mediumblue:205,mediumorchid:12211667,mediumpurple:9662683,mediumseagreen:3978097,mediumslateblue:8087790,mediumspringgreen:64154,mediumturquoise:4772300,mediumvioletred:13047173,midnightblue:1644912,mintcream:16121850,mistyrose:16770273,moccasin:16770229,navajowhite:16768685,navy:128,oldlace:16643558,olive:8421376,olivedrab:7048739,orange:16753920,orangered:16729344,orchid:14315734,palegoldenrod:15657130,palegreen:10025880,paleturquoise:11529966,palevioletred:14381203,papayawhip:16773077,peachpuff:16767673,peru:13468991,pink:16761035,plum:14524637,powderblue:11591910,purple:8388736,rebeccapurple:6697881,red:16711680,rosybrown:12357519,royalblue:4286945,saddlebrown:9127187,salmon:16416882,sandybrown:16032864,seagreen:3050327,seashell:16774638,sienna:10506797,silver:12632256,skyblue:8900331,slateblue:6970061,slategray:7372944,slategrey:7372944,snow:16775930,springgreen:65407,steelblue:4620980,tan:13808780,teal:32896,thistle:14204888,tomato:16737095,turquoise:4251856,violet:15631086,wheat:16113331,white:16777215,whitesmoke:16119285,yellow:16776960,yellowgreen:10145074},Li={h:0,s:0,l:0},Wo={h:0,s:0,l:0};function Qc(i,t,e){return e<0&&(e+=1),e>1&&(e-=1),e<1/6?i+(t-i)*6*e:e<1/2?t:e<2/3?i+(t-i)*6*(2/3-e):i}var Yt=class{constructor(t,e,n){return this.isColor=!0,this.r=1,this.g=1,this.b=1,this.set(t,e,n)}set(t,e,n){if(e===void 0&&n===void 0){let s=t;s&&s.isColor?this.copy(s):typeof s=="number"?this.setHex(s):typeof s=="string"&&this.setStyle(s)}else this.setRGB(t,e,n);return this}setScalar(t){return this.r=t,this.g=t,this.b=t,this}setHex(t,e=_n){return t=Math.floor(t),this.r=(t>>16&255)/255,this.g=(t>>8&255)/255,this.b=(t&255)/255,se.colorSpaceToWorking(this,e),this}setRGB(t,e,n,s=se.workingColorSpace){return this.r=t,this.g=e,this.b=n,se.colorSpaceToWorking(this,s),this}setHSL(t,e,n,s=se.workingColorSpace){if(t=ru(t,1),e=ee(e,0,1),n=ee(n,0,1),e===0)this.r=this.g=this.b=n;else{let r=n<=.5?n*(1+e):n+e-n*e,o=2*n-r;this.r=Qc(o,r,t+1/3),this.g=Qc(o,r,t),this.b=Qc(o,r,t-1/3)}return se.colorSpaceToWorking(this,s),this}setStyle(t,e=_n){function n(r){r!==void 0&&parseFloat(r)<1&&Vt("Color: Alpha component of "+t+" will be ignored.")}let s;if(s=/^(\w+)\(([^\)]*)\)/.exec(t)){let r,o=s[1],a=s[2];switch(o){case"rgb":case"rgba":if(r=/^\s*(\d+)\s*,\s*(\d+)\s*,\s*(\d+)\s*(?:,\s*(\d+(?:\.\d+)?|\.\d+)\s*)?$/.exec(a))return n(r[4]),this.setRGB(Math.min(255,parseInt(r[1],10))/255,Math.min(255,parseInt(r[2],10))/255,Math.min(255,parseInt(r[3],10))/255,e);if(r=/^\s*(\d+(?:\.\d+)?|\.\d+)\%\s*,\s*(\d+(?:\.\d+)?|\.\d+)\%\s*,\s*(\d+(?:\.\d+)?|\.\d+)\%\s*(?:,\s*(\d+(?:\.\d+)?|\.\d+)\s*)?$/.exec(a))return n(r[4]),this.setRGB(Math.min(100,parseFloat(r[1]))/100,Math.min(100,parseFloat(r[2]))/100,Math.min(100,parseFloat(r[3]))/100,e);break;case"hsl":case"hsla":if(r=/^\s*([+-]?(?:\d+(?:\.\d+)?|\.\d+))\s*,\s*(\d+(?:\.\d+)?|\.\d+)\%\s*,\s*(\d+(?:\.\d+)?|\.\d+)\%\s*(?:,\s*(\d+(?:\.\d+)?|\.\d+)\s*)?$/.exec(a))return n(r[4]),this.setHSL(parseFloat(r[1])/360,parseFloat(r[2])/100,parseFloat(r[3])/100,e);break;default:Vt("Color: Unknown color model "+t)}}else if(s=/^\#([A-Fa-f\d]+)$/.exec(t)){let r=s[1],o=r.length;if(o===3)return this.setRGB(parseInt(r.charAt(0),16)/15,parseInt(r.charAt(1),16)/15,parseInt(r.charAt(2),16)/15,e);if(o===6)return this.setHex(parseInt(r,16),e);Vt("Color: Invalid hex color "+t)}else if(t&&t.length>0)return this.setColorName(t,e);return this}setColorName(t,e=_n){let n=fp[t.toLowerCase()];return n!==void 0?this.setHex(n,e):Vt("Color: Unknown color "+t),this}clone(){return new this.constructor(this.r,this.g,this.b)}copy(t){return this.r=t.r,this.g=t.g,this.b=t.b,this}copySRGBToLinear(t){return this.r=mi(t.r),this.g=mi(t.g),this.b=mi(t.b),this}copyLinearToSRGB(t){return this.r=Ns(t.r),this.g=Ns(t.g),this.b=Ns(t.b),this}convertSRGBToLinear(){return this.copySRGBToLinear(this),this}convertLinearToSRGB(){return this.copyLinearToSRGB(this),this}getHex(t=_n){return se.workingToColorSpace(nn.copy(this),t),Math.round(ee(nn.r*255,0,255))*65536+Math.round(ee(nn.g*255,0,255))*256+Math.round(ee(nn.b*255,0,255))}getHexString(t=_n){return("000000"+this.getHex(t).toString(16)).slice(-6)}getHSL(t,e=se.workingColorSpace){se.workingToColorSpace(nn.copy(this),e);let n=nn.r,s=nn.g,r=nn.b,o=Math.max(n,s,r),a=Math.min(n,s,r),l,c,h=(a+o)/2;if(a===o)l=0,c=0;else{let u=o-a;switch(c=h<=.5?u/(o+a):u/(2-o-a),o){case n:l=(s-r)/u+(s<r?6:0);break;case s:l=(r-n)/u+2;break;case r:l=(n-s)/u+4;break}l/=6}return t.h=l,t.s=c,t.l=h,t}getRGB(t,e=se.workingColorSpace){return se.workingToColorSpace(nn.copy(this),e),t.r=nn.r,t.g=nn.g,t.b=nn.b,t}getStyle(t=_n){se.workingToColorSpace(nn.copy(this),t);let e=nn.r,n=nn.g,s=nn.b;return t!==_n?`color(${t} ${e.toFixed(3)} ${n.toFixed(3)} ${s.toFixed(3)})`:`rgb(${Math.round(e*255)},${Math.round(n*255)},${Math.round(s*255)})`}offsetHSL(t,e,n){return this.getHSL(Li),this.setHSL(Li.h+t,Li.s+e,Li.l+n)}add(t){return this.r+=t.r,this.g+=t.g,this.b+=t.b,this}addColors(t,e){return this.r=t.r+e.r,this.g=t.g+e.g,this.b=t.b+e.b,this}addScalar(t){return this.r+=t,this.g+=t,this.b+=t,this}sub(t){return this.r=Math.max(0,this.r-t.r),this.g=Math.max(0,this.g-t.g),this.b=Math.max(0,this.b-t.b),this}multiply(t){return this.r*=t.r,this.g*=t.g,this.b*=t.b,this}multiplyScalar(t){return this.r*=t,this.g*=t,this.b*=t,this}lerp(t,e){return this.r+=(t.r-this.r)*e,this.g+=(t.g-this.g)*e,this.b+=(t.b-this.b)*e,this}lerpColors(t,e,n){return this.r=t.r+(e.r-t.r)*n,this.g=t.g+(e.g-t.g)*n,this.b=t.b+(e.b-t.b)*n,this}lerpHSL(t,e){this.getHSL(Li),t.getHSL(Wo);let n=wr(Li.h,Wo.h,e),s=wr(Li.s,Wo.s,e),r=wr(Li.l,Wo.l,e);return this.setHSL(n,s,r),this}setFromVector3(t){return this.r=t.x,this.g=t.y,this.b=t.z,this}applyMatrix3(t){let e=this.r,n=this.g,s=this.b,r=t.elements;return this.r=r[0]*e+r[3]*n+r[6]*s,this.g=r[1]*e+r[4]*n+r[7]*s,this.b=r[2]*e+r[5]*n+r[8]*s,this}equals(t){return t.r===this.r&&t.g===this.g&&t.b===this.b}fromArray(t,e=0){return this.r=t[e],this.g=t[e+1],this.b=t[e+2],this}toArray(t=[],e=0){return t[e]=this.r,t[e+1]=this.g,t[e+2]=this.b,t}fromBufferAttribute(t,e){return this.r=t.getX(e),this.g=t.getY(e),this.b=t.getZ(e),this}toJSON(){return this.getHex()}*[Symbol.iterator](){yield this.r,yield this.g,yield this.b}},nn=new Yt;Yt.NAMES=fp;var Gs=class extends dn{constructor(){super(),this.isScene=!0,this.type="Scene",this.background=null,this.environment=null,this.fog=null,this.backgroundBlurriness=0,this.backgroundIntensity=1,this.backgroundRotation=new Oi,this.environmentIntensity=1,this.environmentRotation=new Oi,this.overrideMaterial=null,typeof __THREE_DEVTOOLS__<"u"&&__THREE_DEVTOOLS__.dispatchEvent(new CustomEvent("observe",{detail:this}))}copy(t,e){return super.copy(t,e),this.background=t.background!==null?t.background.clone():null,this.environment=t.environment!==null?t.environment.clone():null,this.fog=t.fog!==null?t.fog.clone():null,this.backgroundBlurriness=t.backgroundBlurriness,this.backgroundIntensity=t.backgroundIntensity,this.backgroundRotation.copy(t.backgroundRotation),this.environmentIntensity=t.environmentIntensity,this.environmentRotation.copy(t.environmentRotation),this.overrideMaterial=t.overrideMaterial!==null?t.overrideMaterial.clone():null,this.matrixAutoUpdate=t.matrixAutoUpdate,this}toJSON(t){let e=super.toJSON(t);return this.fog!==null&&(e.object.fog=this.fog.toJSON()),e.object.backgroundBlurriness=this.backgroundBlurriness,e.object.backgroundIntensity=this.backgroundIntensity,e.object.backgroundRotation=this.backgroundRotation.toArray(),e.object.environmentIntensity=this.environmentIntensity,e.object.environmentRotation=this.environmentRotation.toArray(),e}},On=new I,hi=new I,th=new I,ui=new I,Ms=new I,Ss=new I,of=new I,eh=new I,nh=new I,ih=new I,sh=new Te,rh=new Te,oh=new Te,pi=class i{constructor(t=new I,e=new I,n=new I){this.a=t,this.b=e,this.c=n}static getNormal(t,e,n,s){s.subVectors(n,e),On.subVectors(t,e),s.cross(On);let r=s.lengthSq();return r>0?s.multiplyScalar(1/Math.sqrt(r)):s.set(0,0,0)}static getBarycoord(t,e,n,s,r){On.subVectors(s,e),hi.subVectors(n,e),th.subVectors(t,e);let o=On.dot(On),a=On.dot(hi),l=On.dot(th),c=hi.dot(hi),h=hi.dot(th),u=o*c-a*a;if(u===0)return r.set(0,0,0),null;let d=1/u,f=(c*l-a*h)*d,m=(o*h-a*l)*d;return r.set(1-f-m,m,f)}static containsPoint(t,e,n,s){return this.getBarycoord(t,e,n,s,ui)===null?!1:ui.x>=0&&ui.y>=0&&ui.x+ui.y<=1}static getInterpolation(t,e,n,s,r,o,a,l){return this.getBarycoord(t,e,n,s,ui)===null?(l.x=0,l.y=0,"z"in l&&(l.z=0),"w"in l&&(l.w=0),null):(l.setScalar(0),l.addScaledVector(r,ui.x),l.addScaledVector(o,ui.y),l.addScaledVector(a,ui.z),l)}static getInterpolatedAttribute(t,e,n,s,r,o){return sh.setScalar(0),rh.setScalar(0),oh.setScalar(0),sh.fromBufferAttribute(t,e),rh.fromBufferAttribute(t,n),oh.fromBufferAttribute(t,s),o.setScalar(0),o.addScaledVector(sh,r.x),o.addScaledVector(rh,r.y),o.addScaledVector(oh,r.z),o}static isFrontFacing(t,e,n,s){return On.subVectors(n,e),hi.subVectors(t,e),On.cross(hi).dot(s)<0}set(t,e,n){return this.a.copy(t),this.b.copy(e),this.c.copy(n),this}setFromPointsAndIndices(t,e,n,s){return this.a.copy(t[e]),this.b.copy(t[n]),this.c.copy(t[s]),this}setFromAttributeAndIndices(t,e,n,s){return this.a.fromBufferAttribute(t,e),this.b.fromBufferAttribute(t,n),this.c.fromBufferAttribute(t,s),this}clone(){return new this.constructor().copy(this)}copy(t){return this.a.copy(t.a),this.b.copy(t.b),this.c.copy(t.c),this}getArea(){return On.subVectors(this.c,this.b),hi.subVectors(this.a,this.b),On.cross(hi).length()*.5}getMidpoint(t){return t.addVectors(this.a,this.b).add(this.c).multiplyScalar(1/3)}getNormal(t){return i.getNormal(this.a,this.b,this.c,t)}getPlane(t){return t.setFromCoplanarPoints(this.a,this.b,this.c)}getBarycoord(t,e){return i.getBarycoord(t,this.a,this.b,this.c,e)}getInterpolation(t,e,n,s,r){return i.getInterpolation(t,this.a,this.b,this.c,e,n,s,r)}containsPoint(t){return i.containsPoint(t,this.a,this.b,this.c)}isFrontFacing(t){return i.isFrontFacing(this.a,this.b,this.c,t)}intersectsBox(t){return t.intersectsTriangle(this)}closestPointToPoint(t,e){let n=this.a,s=this.b,r=this.c,o,a;Ms.subVectors(s,n),Ss.subVectors(r,n),eh.subVectors(t,n);let l=Ms.dot(eh),c=Ss.dot(eh);if(l<=0&&c<=0)return e.copy(n);nh.subVectors(t,s);let h=Ms.dot(nh),u=Ss.dot(nh);if(h>=0&&u<=h)return e.copy(s);let d=l*u-h*c;if(d<=0&&l>=0&&h<=0&&l-h>0)return o=l/(l-h),e.copy(n).addScaledVector(Ms,o);ih.subVectors(t,r);let f=Ms.dot(ih),m=Ss.dot(ih);if(m>=0&&f<=m)return e.copy(r);let x=f*c-l*m;if(x<=0&&c>=0&&m<=0)return a=c/(c-m),e.copy(n).addScaledVector(Ss,a);let p=h*m-f*u;if(p<=0&&u-h>=0&&f-m>=0)return of.subVectors(r,s),a=(u-h)/(u-h+(f-m)),e.copy(s).addScaledVector(of,a);let g=1/(p+x+d);return o=x*g,a=d*g,e.copy(n).addScaledVector(Ms,o).addScaledVector(Ss,a)}equals(t){return t.a.equals(this.a)&&t.b.equals(this.b)&&t.c.equals(this.c)}},Jn=class{constructor(t=new I(1/0,1/0,1/0),e=new I(-1/0,-1/0,-1/0)){this.isBox3=!0,this.min=t,this.max=e}set(t,e){return this.min.copy(t),this.max.copy(e),this}setFromArray(t){this.makeEmpty();for(let e=0,n=t.length;e<n;e+=3)this.expandByPoint(Fn.fromArray(t,e));return this}setFromBufferAttribute(t){this.makeEmpty();for(let e=0,n=t.count;e<n;e++)this.expandByPoint(Fn.fromBufferAttribute(t,e));return this}setFromPoints(t){this.makeEmpty();for(let e=0,n=t.length;e<n;e++)this.expandByPoint(t[e]);return this}setFromCenterAndSize(t,e){let n=Fn.copy(e).multiplyScalar(.5);return this.min.copy(t).sub(n),this.max.copy(t).add(n),this}setFromObject(t,e=!1){return this.makeEmpty(),this.expandByObject(t,e)}clone(){return new this.constructor().copy(this)}copy(t){return this.min.copy(t.min),this.max.copy(t.max),this}makeEmpty(){return this.min.x=this.min.y=this.min.z=1/0,this.max.x=this.max.y=this.max.z=-1/0,this}isEmpty(){return this.max.x<this.min.x||this.max.y<this.min.y||this.max.z<this.min.z}getCenter(t){return this.isEmpty()?t.set(0,0,0):t.addVectors(this.min,this.max).multiplyScalar(.5)}getSize(t){return this.isEmpty()?t.set(0,0,0):t.subVectors(this.max,this.min)}expandByPoint(t){return this.min.min(t),this.max.max(t),this}expandByVector(t){return this.min.sub(t),this.max.add(t),this}expandByScalar(t){return this.min.addScalar(-t),this.max.addScalar(t),this}expandByObject(t,e=!1){t.updateWorldMatrix(!1,!1);let n=t.geometry;if(n!==void 0){let r=n.getAttribute("position");if(e===!0&&r!==void 0&&t.isInstancedMesh!==!0&&t.isBatchedMesh!==!0)for(let o=0,a=r.count;o<a;o++)t.isMesh===!0?t.getVertexPosition(o,Fn):Fn.fromBufferAttribute(r,o),Fn.applyMatrix4(t.matrixWorld),this.expandByPoint(Fn);else t.boundingBox!==void 0?(t.boundingBox===null&&t.computeBoundingBox(),Xo.copy(t.boundingBox)):(n.boundingBox===null&&n.computeBoundingBox(),Xo.copy(n.boundingBox)),Xo.applyMatrix4(t.matrixWorld),this.union(Xo)}let s=t.children;for(let r=0,o=s.length;r<o;r++)this.expandByObject(s[r],e);return this}containsPoint(t){return t.x>=this.min.x&&t.x<=this.max.x&&t.y>=this.min.y&&t.y<=this.max.y&&t.z>=this.min.z&&t.z<=this.max.z}containsBox(t){return this.min.x<=t.min.x&&t.max.x<=this.max.x&&this.min.y<=t.min.y&&t.max.y<=this.max.y&&this.min.z<=t.min.z&&t.max.z<=this.max.z}getParameter(t,e){return e.set((t.x-this.min.x)/(this.max.x-this.min.x),(t.y-this.min.y)/(this.max.y-this.min.y),(t.z-this.min.z)/(this.max.z-this.min.z))}intersectsBox(t){return t.max.x>=this.min.x&&t.min.x<=this.max.x&&t.max.y>=this.min.y&&t.min.y<=this.max.y&&t.max.z>=this.min.z&&t.min.z<=this.max.z}intersectsSphere(t){return this.clampPoint(t.center,Fn),Fn.distanceToSquared(t.center)<=t.radius*t.radius}intersectsPlane(t){let e,n;return t.normal.x>0?(e=t.normal.x*this.min.x,n=t.normal.x*this.max.x):(e=t.normal.x*this.max.x,n=t.normal.x*this.min.x),t.normal.y>0?(e+=t.normal.y*this.min.y,n+=t.normal.y*this.max.y):(e+=t.normal.y*this.max.y,n+=t.normal.y*this.min.y),t.normal.z>0?(e+=t.normal.z*this.min.z,n+=t.normal.z*this.max.z):(e+=t.normal.z*this.max.z,n+=t.normal.z*this.min.z),e<=-t.constant&&n>=-t.constant}intersectsTriangle(t){if(this.isEmpty())return!1;this.getCenter(gr),qo.subVectors(this.max,gr),ws.subVectors(t.a,gr),Es.subVectors(t.b,gr),As.subVectors(t.c,gr),Di.subVectors(Es,ws),Ni.subVectors(As,Es),Ki.subVectors(ws,As);let e=[0,-Di.z,Di.y,0,-Ni.z,Ni.y,0,-Ki.z,Ki.y,Di.z,0,-Di.x,Ni.z,0,-Ni.x,Ki.z,0,-Ki.x,-Di.y,Di.x,0,-Ni.y,Ni.x,0,-Ki.y,Ki.x,0];return!ah(e,ws,Es,As,qo)||(e=[1,0,0,0,1,0,0,0,1],!ah(e,ws,Es,As,qo))?!1:($o.crossVectors(Di,Ni),e=[$o.x,$o.y,$o.z],ah(e,ws,Es,As,qo))}clampPoint(t,e){return e.copy(t).clamp(this.min,this.max)}distanceToPoint(t){return this.clampPoint(t,Fn).distanceTo(t)}getBoundingSphere(t){return this.isEmpty()?t.makeEmpty():(this.getCenter(t.center),t.radius=this.getSize(Fn).length()*.5),t}intersect(t){return this.min.max(t.min),this.max.min(t.max),this.isEmpty()&&this.makeEmpty(),this}union(t){return this.min.min(t.min),this.max.max(t.max),this}applyMatrix4(t){return this.isEmpty()?this:(di[0].set(this.min.x,this.min.y,this.min.z).applyMatrix4(t),di[1].set(this.min.x,this.min.y,this.max.z).applyMatrix4(t),di[2].set(this.min.x,this.max.y,this.min.z).applyMatrix4(t),di[3].set(this.min.x,this.max.y,this.max.z).applyMatrix4(t),di[4].set(this.max.x,this.min.y,this.min.z).applyMatrix4(t),di[5].set(this.max.x,this.min.y,this.max.z).applyMatrix4(t),di[6].set(this.max.x,this.max.y,this.min.z).applyMatrix4(t),di[7].set(this.max.x,this.max.y,this.max.z).applyMatrix4(t),this.setFromPoints(di),this)}translate(t){return this.min.add(t),this.max.add(t),this}equals(t){return t.min.equals(this.min)&&t.max.equals(this.max)}toJSON(){return{min:this.min.toArray(),max:this.max.toArray()}}fromJSON(t){return this.min.fromArray(t.min),this.max.fromArray(t.max),this}},di=[new I,new I,new I,new I,new I,new I,new I,new I],Fn=new I,Xo=new Jn,ws=new I,Es=new I,As=new I,Di=new I,Ni=new I,Ki=new I,gr=new I,qo=new I,$o=new I,Qi=new I;function ah(i,t,e,n,s){for(let r=0,o=i.length-3;r<=o;r+=3){Qi.fromArray(i,r);let a=s.x*Math.abs(Qi.x)+s.y*Math.abs(Qi.y)+s.z*Math.abs(Qi.z),l=t.dot(Qi),c=e.dot(Qi),h=n.dot(Qi);if(Math.max(-Math.max(l,c,h),Math.min(l,c,h))>a)return!1}return!0}var ke=new I,Yo=new rt,G0=0,Ce=class extends Bn{constructor(t,e,n=!1){if(super(),Array.isArray(t))throw new TypeError("THREE.BufferAttribute: array should be a Typed Array.");this.isBufferAttribute=!0,Object.defineProperty(this,"id",{value:G0++}),this.name="",this.array=t,this.itemSize=e,this.count=t!==void 0?t.length/e:0,this.normalized=n,this.usage=op,this.updateRanges=[],this.gpuType=fn,this.version=0,this._normalizationScale=t!==void 0?au(t):void 0}onUploadCallback(){}set needsUpdate(t){t===!0&&this.version++}setUsage(t){return this.usage=t,this}addUpdateRange(t,e){this.updateRanges.push({start:t,count:e})}clearUpdateRanges(){this.updateRanges.length=0}copy(t){return this.name=t.name,this.array=new t.array.constructor(t.array),this.itemSize=t.itemSize,this.count=t.count,this.normalized=t.normalized,this.usage=t.usage,this.gpuType=t.gpuType,this._normalizationScale=t._normalizationScale,this}copyAt(t,e,n){t*=this.itemSize,n*=e.itemSize;for(let s=0,r=this.itemSize;s<r;s++)this.array[t+s]=e.array[n+s];return this}copyArray(t){return this.array.set(t),this}applyMatrix3(t){if(this.itemSize===2)for(let e=0,n=this.count;e<n;e++)Yo.fromBufferAttribute(this,e),Yo.applyMatrix3(t),this.setXY(e,Yo.x,Yo.y);else if(this.itemSize===3)for(let e=0,n=this.count;e<n;e++)ke.fromBufferAttribute(this,e),ke.applyMatrix3(t),this.setXYZ(e,ke.x,ke.y,ke.z);return this}applyMatrix4(t){for(let e=0,n=this.count;e<n;e++)ke.fromBufferAttribute(this,e),ke.applyMatrix4(t),this.setXYZ(e,ke.x,ke.y,ke.z);return this}applyNormalMatrix(t){for(let e=0,n=this.count;e<n;e++)ke.fromBufferAttribute(this,e),ke.applyNormalMatrix(t),this.setXYZ(e,ke.x,ke.y,ke.z);return this}transformDirection(t){for(let e=0,n=this.count;e<n;e++)ke.fromBufferAttribute(this,e),ke.transformDirection(t),this.setXYZ(e,ke.x,ke.y,ke.z);return this}set(t,e=0){return this.array.set(t,e),this}getComponent(t,e){let n=this.array[t*this.itemSize+e];return this.normalized&&(n=this._denormalize(n)),n}setComponent(t,e,n){return this.normalized&&(n=this._normalize(n)),this.array[t*this.itemSize+e]=n,this}getX(t){let e=this.array[t*this.itemSize];return this.normalized&&(e=this._denormalize(e)),e}setX(t,e){return this.normalized&&(e=this._normalize(e)),this.array[t*this.itemSize]=e,this}getY(t){let e=this.array[t*this.itemSize+1];return this.normalized&&(e=this._denormalize(e)),e}setY(t,e){return this.normalized&&(e=this._normalize(e)),this.array[t*this.itemSize+1]=e,this}getZ(t){let e=this.array[t*this.itemSize+2];return this.normalized&&(e=this._denormalize(e)),e}setZ(t,e){return this.normalized&&(e=this._normalize(e)),this.array[t*this.itemSize+2]=e,this}getW(t){let e=this.array[t*this.itemSize+3];return this.normalized&&(e=this._denormalize(e)),e}setW(t,e){return this.normalized&&(e=this._normalize(e)),this.array[t*this.itemSize+3]=e,this}setXY(t,e,n){return t*=this.itemSize,this.normalized&&(e=this._normalize(e),n=this._normalize(n)),this.array[t+0]=e,this.array[t+1]=n,this}setXYZ(t,e,n,s){return t*=this.itemSize,this.normalized&&(e=this._normalize(e),n=this._normalize(n),s=this._normalize(s)),this.array[t+0]=e,this.array[t+1]=n,this.array[t+2]=s,this}setXYZW(t,e,n,s,r){return t*=this.itemSize,this.normalized&&(e=this._normalize(e),n=this._normalize(n),s=this._normalize(s),r=this._normalize(r)),this.array[t+0]=e,this.array[t+1]=n,this.array[t+2]=s,this.array[t+3]=r,this}onUpload(t){return this.onUploadCallback=t,this}clone(){return new this.constructor(this.array,this.itemSize).copy(this)}toJSON(){let t={itemSize:this.itemSize,type:this.array.constructor.name,array:Array.from(this.array),normalized:this.normalized};return t.name=this.name,t.usage=this.usage,t.gpuType=this.gpuType,t}dispose(){this.dispatchEvent({type:"dispose"})}_denormalize(t){let e=this._normalizationScale;return e!==void 0?Math.max(t/e,-1):up(t,this.array)}_normalize(t){let e=this._normalizationScale;return e!==void 0?Math.round(t*e):dp(t,this.array)}};var Lr=class extends Ce{constructor(t,e,n){super(new Uint16Array(t),e,n)}};var Dr=class extends Ce{constructor(t,e,n){super(new Uint32Array(t),e,n)}};var ze=class extends Ce{constructor(t,e,n){super(new Float32Array(t),e,n)}},V0=new Jn,_r=new I,lh=new I,jn=class{constructor(t=new I,e=-1){this.isSphere=!0,this.center=t,this.radius=e}set(t,e){return this.center.copy(t),this.radius=e,this}setFromPoints(t,e){let n=this.center;e!==void 0?n.copy(e):V0.setFromPoints(t).getCenter(n);let s=0;for(let r=0,o=t.length;r<o;r++)s=Math.max(s,n.distanceToSquared(t[r]));return this.radius=Math.sqrt(s),this}copy(t){return this.center.copy(t.center),this.radius=t.radius,this}isEmpty(){return this.radius<0}makeEmpty(){return this.center.set(0,0,0),this.radius=-1,this}containsPoint(t){return t.distanceToSquared(this.center)<=this.radius*this.radius}distanceToPoint(t){return t.distanceTo(this.center)-this.radius}intersectsSphere(t){let e=this.radius+t.radius;return t.center.distanceToSquared(this.center)<=e*e}intersectsBox(t){return t.intersectsSphere(this)}intersectsPlane(t){return Math.abs(t.distanceToPoint(this.center))<=this.radius}clampPoint(t,e){let n=this.center.distanceToSquared(t);return e.copy(t),n>this.radius*this.radius&&(e.sub(this.center).normalize(),e.multiplyScalar(this.radius).add(this.center)),e}getBoundingBox(t){return this.isEmpty()?(t.makeEmpty(),t):(t.set(this.center,this.center),t.expandByScalar(this.radius),t)}applyMatrix4(t){return this.center.applyMatrix4(t),this.radius=this.radius*t.getMaxScaleOnAxis(),this}translate(t){return this.center.add(t),this}expandByPoint(t){if(this.isEmpty())return this.center.copy(t),this.radius=0,this;_r.subVectors(t,this.center);let e=_r.lengthSq();if(e>this.radius*this.radius){let n=Math.sqrt(e),s=(n-this.radius)*.5;this.center.addScaledVector(_r,s/n),this.radius+=s}return this}union(t){return t.isEmpty()?this:this.isEmpty()?(this.copy(t),this):(this.center.equals(t.center)===!0?this.radius=Math.max(this.radius,t.radius):(lh.subVectors(t.center,this.center).setLength(t.radius),this.expandByPoint(_r.copy(t.center).add(lh)),this.expandByPoint(_r.copy(t.center).sub(lh))),this)}equals(t){return t.center.equals(this.center)&&t.radius===this.radius}clone(){return new this.constructor().copy(this)}toJSON(){return{radius:this.radius,center:this.center.toArray()}}fromJSON(t){return this.radius=t.radius,this.center.fromArray(t.center),this}},H0=0,Tn=new ue,ch=new dn,Ts=new I,gn=new Jn,xr=new Jn,$e=new I,Se=class i extends Bn{constructor(){super(),this.isBufferGeometry=!0,Object.defineProperty(this,"id",{value:H0++}),this.uuid=us(),this.name="",this.type="BufferGeometry",this.index=null,this.indirect=null,this.indirectOffset=0,this.attributes={},this.morphAttributes={},this.morphTargetsRelative=!1,this.groups=[],this.boundingBox=null,this.boundingSphere=null,this.drawRange={start:0,count:1/0},this.userData={},this._transformed=!1}getIndex(){return this.index}setIndex(t){return Array.isArray(t)?this.index=new(p0(t)?Dr:Lr)(t,1):this.index=t,this}setIndirect(t,e=0){return this.indirect=t,this.indirectOffset=e,this}getIndirect(){return this.indirect}getAttribute(t){return this.attributes[t]}setAttribute(t,e){return this.attributes[t]=e,this}deleteAttribute(t){return delete this.attributes[t],this}hasAttribute(t){return this.attributes[t]!==void 0}addGroup(t,e,n=0){this.groups.push({start:t,count:e,materialIndex:n})}clearGroups(){this.groups=[]}setDrawRange(t,e){this.drawRange.start=t,this.drawRange.count=e}applyMatrix4(t){let e=this.attributes.position;e!==void 0&&(e.applyMatrix4(t),e.needsUpdate=!0);let n=this.attributes.normal;if(n!==void 0){let r=new $t().getNormalMatrix(t);n.applyNormalMatrix(r),n.needsUpdate=!0}let s=this.attributes.tangent;return s!==void 0&&(s.transformDirection(t),s.needsUpdate=!0),this.boundingBox!==null&&this.computeBoundingBox(),this.boundingSphere!==null&&this.computeBoundingSphere(),this._transformed=!0,this}applyQuaternion(t){return Tn.makeRotationFromQuaternion(t),this.applyMatrix4(Tn),this}rotateX(t){return Tn.makeRotationX(t),this.applyMatrix4(Tn),this}rotateY(t){return Tn.makeRotationY(t),this.applyMatrix4(Tn),this}rotateZ(t){return Tn.makeRotationZ(t),this.applyMatrix4(Tn),this}translate(t,e,n){return Tn.makeTranslation(t,e,n),this.applyMatrix4(Tn),this}scale(t,e,n){return Tn.makeScale(t,e,n),this.applyMatrix4(Tn),this}lookAt(t){return ch.lookAt(t),ch.updateMatrix(),this.applyMatrix4(ch.matrix),this}center(){return this.computeBoundingBox(),this.boundingBox.getCenter(Ts).negate(),this.translate(Ts.x,Ts.y,Ts.z),this}setFromPoints(t){let e=this.getAttribute("position");if(e===void 0){let n=[];for(let s=0,r=t.length;s<r;s++){let o=t[s];n.push(o.x,o.y,o.z||0)}this.setAttribute("position",new ze(n,3))}else{let n=Math.min(t.length,e.count);for(let s=0;s<n;s++){let r=t[s];e.setXYZ(s,r.x,r.y,r.z||0)}t.length>e.count&&Vt("BufferGeometry: Buffer size too small for points data. Use .dispose() and create a new geometry."),e.needsUpdate=!0}return this}computeBoundingBox(){this.boundingBox===null&&(this.boundingBox=new Jn);let t=this.attributes.position,e=this.morphAttributes.position;if(t&&t.isGLBufferAttribute){Wt("BufferGeometry.computeBoundingBox(): GLBufferAttribute requires a manual bounding box.",this),this.boundingBox.set(new I(-1/0,-1/0,-1/0),new I(1/0,1/0,1/0));return}if(t!==void 0){if(this.boundingBox.setFromBufferAttribute(t),e)for(let n=0,s=e.length;n<s;n++){let r=e[n];gn.setFromBufferAttribute(r),this.morphTargetsRelative?($e.addVectors(this.boundingBox.min,gn.min),this.boundingBox.expandByPoint($e),$e.addVectors(this.boundingBox.max,gn.max),this.boundingBox.expandByPoint($e)):(this.boundingBox.expandByPoint(gn.min),this.boundingBox.expandByPoint(gn.max))}}else this.boundingBox.makeEmpty();(isNaN(this.boundingBox.min.x)||isNaN(this.boundingBox.min.y)||isNaN(this.boundingBox.min.z))&&Wt('BufferGeometry.computeBoundingBox(): Computed min/max have NaN values. The "position" attribute is likely to have NaN values.',this)}computeBoundingSphere(){this.boundingSphere===null&&(this.boundingSphere=new jn);let t=this.attributes.position,e=this.morphAttributes.position;if(t&&t.isGLBufferAttribute){Wt("BufferGeometry.computeBoundingSphere(): GLBufferAttribute requires a manual bounding sphere.",this),this.boundingSphere.set(new I,1/0);return}if(t){let n=this.boundingSphere.center;if(gn.setFromBufferAttribute(t),e)for(let r=0,o=e.length;r<o;r++){let a=e[r];xr.setFromBufferAttribute(a),this.morphTargetsRelative?($e.addVectors(gn.min,xr.min),gn.expandByPoint($e),$e.addVectors(gn.max,xr.max),gn.expandByPoint($e)):(gn.expandByPoint(xr.min),gn.expandByPoint(xr.max))}gn.getCenter(n);let s=0;for(let r=0,o=t.count;r<o;r++)$e.fromBufferAttribute(t,r),s=Math.max(s,n.distanceToSquared($e));if(e)for(let r=0,o=e.length;r<o;r++){let a=e[r],l=this.morphTargetsRelative;for(let c=0,h=a.count;c<h;c++)$e.fromBufferAttribute(a,c),l&&(Ts.fromBufferAttribute(t,c),$e.add(Ts)),s=Math.max(s,n.distanceToSquared($e))}this.boundingSphere.radius=Math.sqrt(s),isNaN(this.boundingSphere.radius)&&Wt('BufferGeometry.computeBoundingSphere(): Computed radius is NaN. The "position" attribute is likely to have NaN values.',this)}}computeTangents(){let t=this.index,e=this.attributes;if(t===null||e.position===void 0||e.normal===void 0||e.uv===void 0){Wt("BufferGeometry: .computeTangents() failed. Missing required attributes (index, position, normal or uv)");return}let n=e.position,s=e.normal,r=e.uv,o=this.getAttribute("tangent");(o===void 0||o.count!==n.count)&&(o=new Ce(new Float32Array(4*n.count),4),this.setAttribute("tangent",o));let a=[],l=[],c=new Uint8Array(n.count);for(let O=0;O<n.count;O++)a[O]=new I,l[O]=new I;let h=new I,u=new I,d=new I,f=new rt,m=new rt,x=new rt,p=new I,g=new I;function y(O,P,U){c[O]=c[P]=c[U]=1,h.fromBufferAttribute(n,O),u.fromBufferAttribute(n,P),d.fromBufferAttribute(n,U),f.fromBufferAttribute(r,O),m.fromBufferAttribute(r,P),x.fromBufferAttribute(r,U),u.sub(h),d.sub(h),m.sub(f),x.sub(f);let G=1/(m.x*x.y-x.x*m.y);isFinite(G)&&(p.copy(u).multiplyScalar(x.y).addScaledVector(d,-m.y).multiplyScalar(G),g.copy(d).multiplyScalar(m.x).addScaledVector(u,-x.x).multiplyScalar(G),a[O].add(p),a[P].add(p),a[U].add(p),l[O].add(g),l[P].add(g),l[U].add(g))}let w=this.groups;w.length===0&&(w=[{start:0,count:t.count}]);for(let O=0,P=w.length;O<P;++O){let U=w[O],G=U.start,$=U.count;for(let L=G,V=G+$;L<V;L+=3)y(t.getX(L+0),t.getX(L+1),t.getX(L+2))}let S=new I,T=new I,A=new I,_=new I;function E(O){A.fromBufferAttribute(s,O),_.copy(A);let P=a[O];S.copy(P),S.sub(A.multiplyScalar(A.dot(P))).normalize(),T.crossVectors(_,P);let G=T.dot(l[O])<0?-1:1;o.setXYZW(O,S.x,S.y,S.z,G)}for(let O=0,P=n.count;O<P;++O)c[O]&&E(O);this._transformed=!0}computeVertexNormals(){let t=this.index,e=this.getAttribute("position");if(e!==void 0){let n=this.getAttribute("normal");if(n===void 0||n.count!==e.count)n=new Ce(new Float32Array(e.count*3),3),this.setAttribute("normal",n);else for(let d=0,f=n.count;d<f;d++)n.setXYZ(d,0,0,0);let s=new I,r=new I,o=new I,a=new I,l=new I,c=new I,h=new I,u=new I;if(t)for(let d=0,f=t.count;d<f;d+=3){let m=t.getX(d+0),x=t.getX(d+1),p=t.getX(d+2);s.fromBufferAttribute(e,m),r.fromBufferAttribute(e,x),o.fromBufferAttribute(e,p),h.subVectors(o,r),u.subVectors(s,r),h.cross(u),a.fromBufferAttribute(n,m),l.fromBufferAttribute(n,x),c.fromBufferAttribute(n,p),a.add(h),l.add(h),c.add(h),n.setXYZ(m,a.x,a.y,a.z),n.setXYZ(x,l.x,l.y,l.z),n.setXYZ(p,c.x,c.y,c.z)}else for(let d=0,f=e.count;d<f;d+=3)s.fromBufferAttribute(e,d+0),r.fromBufferAttribute(e,d+1),o.fromBufferAttribute(e,d+2),h.subVectors(o,r),u.subVectors(s,r),h.cross(u),n.setXYZ(d+0,h.x,h.y,h.z),n.setXYZ(d+1,h.x,h.y,h.z),n.setXYZ(d+2,h.x,h.y,h.z);this.normalizeNormals(),n.needsUpdate=!0}}normalizeNormals(){let t=this.attributes.normal;for(let e=0,n=t.count;e<n;e++)$e.fromBufferAttribute(t,e),$e.normalize(),t.setXYZ(e,$e.x,$e.y,$e.z)}toNonIndexed(){function t(a,l){let c=a.array,h=a.itemSize,u=a.normalized,d=new c.constructor(l.length*h),f=0,m=0;for(let x=0,p=l.length;x<p;x++){a.isInterleavedBufferAttribute?f=l[x]*a.data.stride+a.offset:f=l[x]*h;for(let g=0;g<h;g++)d[m++]=c[f++]}return new Ce(d,h,u)}if(this.index===null)return Vt("BufferGeometry.toNonIndexed(): BufferGeometry is already non-indexed."),this;let e=new i,n=this.index.array,s=this.attributes;for(let a in s){let l=s[a],c=t(l,n);e.setAttribute(a,c)}let r=this.morphAttributes;for(let a in r){let l=[],c=r[a];for(let h=0,u=c.length;h<u;h++){let d=c[h],f=t(d,n);l.push(f)}e.morphAttributes[a]=l}e.morphTargetsRelative=this.morphTargetsRelative;let o=this.groups;for(let a=0,l=o.length;a<l;a++){let c=o[a];e.addGroup(c.start,c.count,c.materialIndex)}return e}toJSON(){let t={metadata:{version:4.7,type:"BufferGeometry",generator:"BufferGeometry.toJSON"}};if(t.uuid=this.uuid,t.type=this.parameters!==void 0&&this._transformed===!0?"BufferGeometry":this.type,t.name=this.name,Object.keys(this.userData).length>0&&(t.userData=this.userData),this.parameters!==void 0&&this._transformed!==!0){let l=this.parameters;for(let c in l)l[c]!==void 0&&(t[c]=l[c]);return t}t.data={attributes:{}};let e=this.index;e!==null&&(t.data.index={type:e.array.constructor.name,array:Array.prototype.slice.call(e.array)});let n=this.attributes;for(let l in n){let c=n[l];t.data.attributes[l]=c.toJSON(t.data)}let s={},r=!1;for(let l in this.morphAttributes){let c=this.morphAttributes[l],h=[];for(let u=0,d=c.length;u<d;u++){let f=c[u];h.push(f.toJSON(t.data))}h.length>0&&(s[l]=h,r=!0)}r&&(t.data.morphAttributes=s,t.data.morphTargetsRelative=this.morphTargetsRelative);let o=this.groups;o.length>0&&(t.data.groups=JSON.parse(JSON.stringify(o)));let a=this.boundingSphere;return a!==null&&(t.data.boundingSphere=a.toJSON()),t}clone(){return new this.constructor().copy(this)}copy(t){this.index=null,this.attributes={},this.morphAttributes={},this.groups=[],this.boundingBox=null,this.boundingSphere=null;let e={};this.name=t.name;let n=t.index;n!==null&&this.setIndex(n.clone());let s=t.attributes;for(let c in s){let h=s[c];this.setAttribute(c,h.clone(e))}let r=t.morphAttributes;for(let c in r){let h=[],u=r[c];for(let d=0,f=u.length;d<f;d++)h.push(u[d].clone(e));this.morphAttributes[c]=h}this.morphTargetsRelative=t.morphTargetsRelative;let o=t.groups;for(let c=0,h=o.length;c<h;c++){let u=o[c];this.addGroup(u.start,u.count,u.materialIndex)}let a=t.boundingBox;a!==null&&(this.boundingBox=a.clone());let l=t.boundingSphere;return l!==null&&(this.boundingSphere=l.clone()),this.drawRange.start=t.drawRange.start,this.drawRange.count=t.drawRange.count,this.userData=t.userData,this._transformed=t._transformed,this}dispose(){this.dispatchEvent({type:"dispose"})}};var hh=new I,W0=new I,X0=new $t,xn=class{constructor(t=new I(1,0,0),e=0){this.isPlane=!0,this.normal=t,this.constant=e}set(t,e){return this.normal.copy(t),this.constant=e,this}setComponents(t,e,n,s){return this.normal.set(t,e,n),this.constant=s,this}setFromNormalAndCoplanarPoint(t,e){return this.normal.copy(t),this.constant=-e.dot(this.normal),this}setFromCoplanarPoints(t,e,n){let s=hh.subVectors(n,e).cross(W0.subVectors(t,e)).normalize();return this.setFromNormalAndCoplanarPoint(s,t),this}copy(t){return this.normal.copy(t.normal),this.constant=t.constant,this}normalize(){let t=1/this.normal.length();return this.normal.multiplyScalar(t),this.constant*=t,this}negate(){return this.constant*=-1,this.normal.negate(),this}distanceToPoint(t){return this.normal.dot(t)+this.constant}distanceToSphere(t){return this.distanceToPoint(t.center)-t.radius}projectPoint(t,e){return e.copy(t).addScaledVector(this.normal,-this.distanceToPoint(t))}intersectLine(t,e,n=!0){let s=t.delta(hh),r=this.normal.dot(s);if(r===0)return this.distanceToPoint(t.start)===0?e.copy(t.start):null;let o=-(t.start.dot(this.normal)+this.constant)/r;return n===!0&&(o<0||o>1)?null:e.copy(t.start).addScaledVector(s,o)}intersectsLine(t){let e=this.distanceToPoint(t.start),n=this.distanceToPoint(t.end);return e<0&&n>0||n<0&&e>0}intersectsBox(t){return t.intersectsPlane(this)}intersectsSphere(t){return t.intersectsPlane(this)}coplanarPoint(t){return t.copy(this.normal).multiplyScalar(-this.constant)}applyMatrix4(t,e){let n=e||X0.getNormalMatrix(t),s=this.coplanarPoint(hh).applyMatrix4(t),r=this.normal.applyMatrix3(n).normalize();return this.constant=-s.dot(r),this}translate(t){return this.constant-=t.dot(this.normal),this}equals(t){return t.normal.equals(this.normal)&&t.constant===this.constant}clone(){return new this.constructor().copy(this)}toJSON(){return{normal:this.normal.toArray(),constant:this.constant}}fromJSON(t){return this.normal.fromArray(t.normal),this.constant=t.constant,this}},q0=0,_i=class extends Bn{constructor(){super(),this.isMaterial=!0,Object.defineProperty(this,"id",{value:q0++}),this.uuid=us(),this.name="",this.type="Material",this.blending=Ys,this.side=bn,this.vertexColors=!1,this.opacity=1,this.transparent=!1,this.alphaHash=!1,this.blendSrc=Nh,this.blendDst=Uh,this.blendEquation=ls,this.blendSrcAlpha=null,this.blendDstAlpha=null,this.blendEquationAlpha=null,this.blendColor=new Yt(0,0,0),this.blendAlpha=0,this.depthFunc=Us,this.depthTest=!0,this.depthWrite=!0,this.stencilWriteMask=255,this.stencilFunc=Xl,this.stencilRef=0,this.stencilFuncMask=255,this.stencilFail=Ls,this.stencilZFail=Ls,this.stencilZPass=Ls,this.stencilWrite=!1,this.clippingPlanes=null,this.clipIntersection=!1,this.clipShadows=!1,this.shadowSide=null,this.colorWrite=!0,this.precision=null,this.polygonOffset=!1,this.polygonOffsetFactor=0,this.polygonOffsetUnits=0,this.dithering=!1,this.alphaToCoverage=!1,this.premultipliedAlpha=!1,this.forceSinglePass=!1,this.allowOverride=!0,this.visible=!0,this.toneMapped=!0,this.userData={},this.version=0,this._alphaTest=0}get alphaTest(){return this._alphaTest}set alphaTest(t){this._alphaTest>0!=t>0&&this.version++,this._alphaTest=t}onBeforeRender(){}onBeforeCompile(){}customProgramCacheKey(){return this.onBeforeCompile.toString()}setValues(t){if(t!==void 0)for(let e in t){let n=t[e];if(n===void 0){Vt(`Material: parameter '${e}' has value of undefined.`);continue}let s=this[e];if(s===void 0){Vt(`Material: '${e}' is not a property of THREE.${this.type}.`);continue}s&&s.isColor?s.set(n):s&&s.isVector2&&n&&n.isVector2||s&&s.isEuler&&n&&n.isEuler||s&&s.isVector3&&n&&n.isVector3?s.copy(n):this[e]=n}}toJSON(t){let e=t===void 0||typeof t=="string";e&&(t={textures:{},images:{}});let n={metadata:{version:4.7,type:"Material",generator:"Material.toJSON"}};n.uuid=this.uuid,n.type=this.type,n.blending=this.blending,n.side=this.side,n.shadowSide=this.shadowSide,n.vertexColors=this.vertexColors,n.opacity=this.opacity,n.transparent=this.transparent,n.blendSrc=this.blendSrc,n.blendDst=this.blendDst,n.blendEquation=this.blendEquation,n.blendSrcAlpha=this.blendSrcAlpha,n.blendDstAlpha=this.blendDstAlpha,n.blendEquationAlpha=this.blendEquationAlpha,n.blendColor=this.blendColor.getHex(),n.blendAlpha=this.blendAlpha,n.depthFunc=this.depthFunc,n.depthTest=this.depthTest,n.depthWrite=this.depthWrite,n.colorWrite=this.colorWrite,n.clipIntersection=this.clipIntersection,n.clipShadows=this.clipShadows,n.stencilWriteMask=this.stencilWriteMask,n.stencilFunc=this.stencilFunc,n.stencilRef=this.stencilRef,n.stencilFuncMask=this.stencilFuncMask,n.stencilFail=this.stencilFail,n.stencilZFail=this.stencilZFail,n.stencilZPass=this.stencilZPass,n.stencilWrite=this.stencilWrite,n.polygonOffset=this.polygonOffset,n.polygonOffsetFactor=this.polygonOffsetFactor,n.polygonOffsetUnits=this.polygonOffsetUnits,n.dithering=this.dithering,n.alphaTest=this.alphaTest,n.alphaHash=this.alphaHash,n.alphaToCoverage=this.alphaToCoverage,n.premultipliedAlpha=this.premultipliedAlpha,n.forceSinglePass=this.forceSinglePass,n.allowOverride=this.allowOverride,n.visible=this.visible,n.toneMapped=this.toneMapped,n.name=this.name,this.color&&this.color.isColor&&(n.color=this.color.getHex()),this.roughness!==void 0&&(n.roughness=this.roughness),this.metalness!==void 0&&(n.metalness=this.metalness),this.sheen!==void 0&&(n.sheen=this.sheen),this.sheenColor&&this.sheenColor.isColor&&(n.sheenColor=this.sheenColor.getHex()),this.sheenRoughness!==void 0&&(n.sheenRoughness=this.sheenRoughness),this.emissive&&this.emissive.isColor&&(n.emissive=this.emissive.getHex()),this.emissiveIntensity!==void 0&&(n.emissiveIntensity=this.emissiveIntensity),this.specular&&this.specular.isColor&&(n.specular=this.specular.getHex()),this.specularIntensity!==void 0&&(n.specularIntensity=this.specularIntensity),this.specularColor&&this.specularColor.isColor&&(n.specularColor=this.specularColor.getHex()),this.shininess!==void 0&&(n.shininess=this.shininess),this.clearcoat!==void 0&&(n.clearcoat=this.clearcoat),this.clearcoatRoughness!==void 0&&(n.clearcoatRoughness=this.clearcoatRoughness),this.diffuseRoughness!==void 0&&(n.diffuseRoughness=this.diffuseRoughness),this.diffuseRoughnessMap&&this.diffuseRoughnessMap.isTexture&&(n.diffuseRoughnessMap=this.diffuseRoughnessMap.toJSON(t).uuid),this.clearcoatMap&&this.clearcoatMap.isTexture&&(n.clearcoatMap=this.clearcoatMap.toJSON(t).uuid),this.clearcoatRoughnessMap&&this.clearcoatRoughnessMap.isTexture&&(n.clearcoatRoughnessMap=this.clearcoatRoughnessMap.toJSON(t).uuid),this.clearcoatNormalMap&&this.clearcoatNormalMap.isTexture&&(n.clearcoatNormalMap=this.clearcoatNormalMap.toJSON(t).uuid,n.clearcoatNormalScale=this.clearcoatNormalScale.toArray()),this.sheenColorMap&&this.sheenColorMap.isTexture&&(n.sheenColorMap=this.sheenColorMap.toJSON(t).uuid),this.sheenRoughnessMap&&this.sheenRoughnessMap.isTexture&&(n.sheenRoughnessMap=this.sheenRoughnessMap.toJSON(t).uuid),this.dispersion!==void 0&&(n.dispersion=this.dispersion),this.retroreflectivity!==void 0&&(n.retroreflectivity=this.retroreflectivity),this.iridescence!==void 0&&(n.iridescence=this.iridescence),this.iridescenceIOR!==void 0&&(n.iridescenceIOR=this.iridescenceIOR),this.iridescenceThicknessMinimum!==void 0&&(n.iridescenceThicknessMinimum=this.iridescenceThicknessMinimum),this.iridescenceThicknessMaximum!==void 0&&(n.iridescenceThicknessMaximum=this.iridescenceThicknessMaximum),this.iridescenceMap&&this.iridescenceMap.isTexture&&(n.iridescenceMap=this.iridescenceMap.toJSON(t).uuid),this.iridescenceThicknessMap&&this.iridescenceThicknessMap.isTexture&&(n.iridescenceThicknessMap=this.iridescenceThicknessMap.toJSON(t).uuid),this.anisotropy!==void 0&&(n.anisotropy=this.anisotropy),this.anisotropyRotation!==void 0&&(n.anisotropyRotation=this.anisotropyRotation),this.anisotropyMap&&this.anisotropyMap.isTexture&&(n.anisotropyMap=this.anisotropyMap.toJSON(t).uuid),this.map&&this.map.isTexture&&(n.map=this.map.toJSON(t).uuid),this.matcap&&this.matcap.isTexture&&(n.matcap=this.matcap.toJSON(t).uuid),this.alphaMap&&this.alphaMap.isTexture&&(n.alphaMap=this.alphaMap.toJSON(t).uuid),this.lightMap&&this.lightMap.isTexture&&(n.lightMap=this.lightMap.toJSON(t).uuid,n.lightMapIntensity=this.lightMapIntensity),this.aoMap&&this.aoMap.isTexture&&(n.aoMap=this.aoMap.toJSON(t).uuid,n.aoMapIntensity=this.aoMapIntensity),this.bumpMap&&this.bumpMap.isTexture&&(n.bumpMap=this.bumpMap.toJSON(t).uuid,n.bumpScale=this.bumpScale),this.normalMap&&this.normalMap.isTexture&&(n.normalMap=this.normalMap.toJSON(t).uuid,n.normalMapType=this.normalMapType,n.normalScale=this.normalScale.toArray()),this.displacementMap&&this.displacementMap.isTexture&&(n.displacementMap=this.displacementMap.toJSON(t).uuid,n.displacementScale=this.displacementScale,n.displacementBias=this.displacementBias),this.roughnessMap&&this.roughnessMap.isTexture&&(n.roughnessMap=this.roughnessMap.toJSON(t).uuid),this.metalnessMap&&this.metalnessMap.isTexture&&(n.metalnessMap=this.metalnessMap.toJSON(t).uuid),this.emissiveMap&&this.emissiveMap.isTexture&&(n.emissiveMap=this.emissiveMap.toJSON(t).uuid),this.specularMap&&this.specularMap.isTexture&&(n.specularMap=this.specularMap.toJSON(t).uuid),this.specularIntensityMap&&this.specularIntensityMap.isTexture&&(n.specularIntensityMap=this.specularIntensityMap.toJSON(t).uuid),this.specularColorMap&&this.specularColorMap.isTexture&&(n.specularColorMap=this.specularColorMap.toJSON(t).uuid),this.envMap&&this.envMap.isTexture&&(n.envMap=this.envMap.toJSON(t).uuid,this.combine!==void 0&&(n.combine=this.combine)),this.envMapRotation!==void 0&&(n.envMapRotation=this.envMapRotation.toArray()),this.envMapIntensity!==void 0&&(n.envMapIntensity=this.envMapIntensity),this.reflectivity!==void 0&&(n.reflectivity=this.reflectivity),this.refractionRatio!==void 0&&(n.refractionRatio=this.refractionRatio),this.gradientMap&&this.gradientMap.isTexture&&(n.gradientMap=this.gradientMap.toJSON(t).uuid),this.transmission!==void 0&&(n.transmission=this.transmission),this.transmissionMap&&this.transmissionMap.isTexture&&(n.transmissionMap=this.transmissionMap.toJSON(t).uuid),this.thickness!==void 0&&(n.thickness=this.thickness),this.thicknessMap&&this.thicknessMap.isTexture&&(n.thicknessMap=this.thicknessMap.toJSON(t).uuid),this.attenuationDistance!==void 0&&(n.attenuationDistance=this.attenuationDistance),this.attenuationColor!==void 0&&(n.attenuationColor=this.attenuationColor.getHex()),this.size!==void 0&&(n.size=this.size),this.sizeAttenuation!==void 0&&(n.sizeAttenuation=this.sizeAttenuation),Array.isArray(this.clippingPlanes)&&this.clippingPlanes.length>0&&(n.clippingPlanes=this.clippingPlanes.map(r=>r.toJSON())),this.rotation!==void 0&&(n.rotation=this.rotation),this.depthPacking!==void 0&&(n.depthPacking=this.depthPacking),this.linewidth!==void 0&&(n.linewidth=this.linewidth),this.linecap!==void 0&&(n.linecap=this.linecap),this.linejoin!==void 0&&(n.linejoin=this.linejoin),this.dashSize!==void 0&&(n.dashSize=this.dashSize),this.gapSize!==void 0&&(n.gapSize=this.gapSize),this.scale!==void 0&&(n.scale=this.scale),this.wireframe!==void 0&&(n.wireframe=this.wireframe),this.wireframeLinewidth!==void 0&&(n.wireframeLinewidth=this.wireframeLinewidth),this.wireframeLinecap!==void 0&&(n.wireframeLinecap=this.wireframeLinecap),this.wireframeLinejoin!==void 0&&(n.wireframeLinejoin=this.wireframeLinejoin),this.flatShading!==void 0&&(n.flatShading=this.flatShading),this.fog!==void 0&&(n.fog=this.fog),Object.keys(this.userData).length>0&&(n.userData=this.userData);function s(r){let o=[];for(let a in r){let l=r[a];delete l.metadata,o.push(l)}return o}if(e){let r=s(t.textures),o=s(t.images);r.length>0&&(n.textures=r),o.length>0&&(n.images=o)}return n}fromJSON(t,e){if(t.uuid!==void 0&&(this.uuid=t.uuid),t.name!==void 0&&(this.name=t.name),t.color!==void 0&&this.color!==void 0&&this.color.setHex(t.color),t.roughness!==void 0&&(this.roughness=t.roughness),t.metalness!==void 0&&(this.metalness=t.metalness),t.sheen!==void 0&&(this.sheen=t.sheen),t.sheenColor!==void 0&&(this.sheenColor=new Yt().setHex(t.sheenColor)),t.sheenRoughness!==void 0&&(this.sheenRoughness=t.sheenRoughness),t.emissive!==void 0&&this.emissive!==void 0&&this.emissive.setHex(t.emissive),t.specular!==void 0&&this.specular!==void 0&&this.specular.setHex(t.specular),t.specularIntensity!==void 0&&(this.specularIntensity=t.specularIntensity),t.specularColor!==void 0&&this.specularColor!==void 0&&this.specularColor.setHex(t.specularColor),t.shininess!==void 0&&(this.shininess=t.shininess),t.clearcoat!==void 0&&(this.clearcoat=t.clearcoat),t.clearcoatRoughness!==void 0&&(this.clearcoatRoughness=t.clearcoatRoughness),t.diffuseRoughness!==void 0&&(this.diffuseRoughness=t.diffuseRoughness),t.dispersion!==void 0&&(this.dispersion=t.dispersion),t.retroreflectivity!==void 0&&(this.retroreflectivity=t.retroreflectivity),t.iridescence!==void 0&&(this.iridescence=t.iridescence),t.iridescenceIOR!==void 0&&(this.iridescenceIOR=t.iridescenceIOR),t.iridescenceThicknessMinimum!==void 0&&(this.iridescenceThicknessMinimum=t.iridescenceThicknessMinimum),t.iridescenceThicknessMaximum!==void 0&&(this.iridescenceThicknessMaximum=t.iridescenceThicknessMaximum),t.iridescenceThicknessRange!==void 0&&(this.iridescenceThicknessMinimum=t.iridescenceThicknessRange[0],this.iridescenceThicknessMaximum=t.iridescenceThicknessRange[1]),t.transmission!==void 0&&(this.transmission=t.transmission),t.thickness!==void 0&&(this.thickness=t.thickness),t.attenuationDistance!==void 0&&(this.attenuationDistance=t.attenuationDistance),t.attenuationColor!==void 0&&this.attenuationColor!==void 0&&this.attenuationColor.setHex(t.attenuationColor),t.anisotropy!==void 0&&(this.anisotropy=t.anisotropy),t.anisotropyRotation!==void 0&&(this.anisotropyRotation=t.anisotropyRotation),t.fog!==void 0&&(this.fog=t.fog),t.flatShading!==void 0&&(this.flatShading=t.flatShading),t.blending!==void 0&&(this.blending=t.blending),t.combine!==void 0&&(this.combine=t.combine),t.side!==void 0&&(this.side=t.side),t.shadowSide!==void 0&&(this.shadowSide=t.shadowSide),t.opacity!==void 0&&(this.opacity=t.opacity),t.transparent!==void 0&&(this.transparent=t.transparent),t.alphaTest!==void 0&&(this.alphaTest=t.alphaTest),t.alphaHash!==void 0&&(this.alphaHash=t.alphaHash),t.depthFunc!==void 0&&(this.depthFunc=t.depthFunc),t.depthTest!==void 0&&(this.depthTest=t.depthTest),t.depthWrite!==void 0&&(this.depthWrite=t.depthWrite),t.colorWrite!==void 0&&(this.colorWrite=t.colorWrite),t.clippingPlanes!==void 0&&(this.clippingPlanes=t.clippingPlanes.map(n=>new xn().fromJSON(n))),t.clipIntersection!==void 0&&(this.clipIntersection=t.clipIntersection),t.clipShadows!==void 0&&(this.clipShadows=t.clipShadows),t.depthPacking!==void 0&&(this.depthPacking=t.depthPacking),t.blendSrc!==void 0&&(this.blendSrc=t.blendSrc),t.blendDst!==void 0&&(this.blendDst=t.blendDst),t.blendEquation!==void 0&&(this.blendEquation=t.blendEquation),t.blendSrcAlpha!==void 0&&(this.blendSrcAlpha=t.blendSrcAlpha),t.blendDstAlpha!==void 0&&(this.blendDstAlpha=t.blendDstAlpha),t.blendEquationAlpha!==void 0&&(this.blendEquationAlpha=t.blendEquationAlpha),t.blendColor!==void 0&&this.blendColor!==void 0&&this.blendColor.setHex(t.blendColor),t.blendAlpha!==void 0&&(this.blendAlpha=t.blendAlpha),t.stencilWriteMask!==void 0&&(this.stencilWriteMask=t.stencilWriteMask),t.stencilFunc!==void 0&&(this.stencilFunc=t.stencilFunc),t.stencilRef!==void 0&&(this.stencilRef=t.stencilRef),t.stencilFuncMask!==void 0&&(this.stencilFuncMask=t.stencilFuncMask),t.stencilFail!==void 0&&(this.stencilFail=t.stencilFail),t.stencilZFail!==void 0&&(this.stencilZFail=t.stencilZFail),t.stencilZPass!==void 0&&(this.stencilZPass=t.stencilZPass),t.stencilWrite!==void 0&&(this.stencilWrite=t.stencilWrite),t.wireframe!==void 0&&(this.wireframe=t.wireframe),t.wireframeLinewidth!==void 0&&(this.wireframeLinewidth=t.wireframeLinewidth),t.wireframeLinecap!==void 0&&(this.wireframeLinecap=t.wireframeLinecap),t.wireframeLinejoin!==void 0&&(this.wireframeLinejoin=t.wireframeLinejoin),t.rotation!==void 0&&(this.rotation=t.rotation),t.linewidth!==void 0&&(this.linewidth=t.linewidth),t.linecap!==void 0&&(this.linecap=t.linecap),t.linejoin!==void 0&&(this.linejoin=t.linejoin),t.dashSize!==void 0&&(this.dashSize=t.dashSize),t.gapSize!==void 0&&(this.gapSize=t.gapSize),t.scale!==void 0&&(this.scale=t.scale),t.polygonOffset!==void 0&&(this.polygonOffset=t.polygonOffset),t.polygonOffsetFactor!==void 0&&(this.polygonOffsetFactor=t.polygonOffsetFactor),t.polygonOffsetUnits!==void 0&&(this.polygonOffsetUnits=t.polygonOffsetUnits),t.dithering!==void 0&&(this.dithering=t.dithering),t.alphaToCoverage!==void 0&&(this.alphaToCoverage=t.alphaToCoverage),t.premultipliedAlpha!==void 0&&(this.premultipliedAlpha=t.premultipliedAlpha),t.forceSinglePass!==void 0&&(this.forceSinglePass=t.forceSinglePass),t.allowOverride!==void 0&&(this.allowOverride=t.allowOverride),t.visible!==void 0&&(this.visible=t.visible),t.toneMapped!==void 0&&(this.toneMapped=t.toneMapped),t.userData!==void 0&&(this.userData=t.userData),t.vertexColors!==void 0&&(typeof t.vertexColors=="number"?this.vertexColors=t.vertexColors>0:this.vertexColors=t.vertexColors),t.size!==void 0&&(this.size=t.size),t.sizeAttenuation!==void 0&&(this.sizeAttenuation=t.sizeAttenuation),t.map!==void 0&&(this.map=e[t.map]||null),t.matcap!==void 0&&(this.matcap=e[t.matcap]||null),t.alphaMap!==void 0&&(this.alphaMap=e[t.alphaMap]||null),t.bumpMap!==void 0&&(this.bumpMap=e[t.bumpMap]||null),t.bumpScale!==void 0&&(this.bumpScale=t.bumpScale),t.normalMap!==void 0&&(this.normalMap=e[t.normalMap]||null),t.normalMapType!==void 0&&(this.normalMapType=t.normalMapType),t.normalScale!==void 0){let n=t.normalScale;Array.isArray(n)===!1&&(n=[n,n]),this.normalScale=new rt().fromArray(n)}return t.displacementMap!==void 0&&(this.displacementMap=e[t.displacementMap]||null),t.displacementScale!==void 0&&(this.displacementScale=t.displacementScale),t.displacementBias!==void 0&&(this.displacementBias=t.displacementBias),t.roughnessMap!==void 0&&(this.roughnessMap=e[t.roughnessMap]||null),t.metalnessMap!==void 0&&(this.metalnessMap=e[t.metalnessMap]||null),t.emissiveMap!==void 0&&(this.emissiveMap=e[t.emissiveMap]||null),t.emissiveIntensity!==void 0&&(this.emissiveIntensity=t.emissiveIntensity),t.specularMap!==void 0&&(this.specularMap=e[t.specularMap]||null),t.specularIntensityMap!==void 0&&(this.specularIntensityMap=e[t.specularIntensityMap]||null),t.specularColorMap!==void 0&&(this.specularColorMap=e[t.specularColorMap]||null),t.envMap!==void 0&&(this.envMap=e[t.envMap]||null),t.envMapRotation!==void 0&&this.envMapRotation.fromArray(t.envMapRotation),t.envMapIntensity!==void 0&&(this.envMapIntensity=t.envMapIntensity),t.reflectivity!==void 0&&(this.reflectivity=t.reflectivity),t.refractionRatio!==void 0&&(this.refractionRatio=t.refractionRatio),t.lightMap!==void 0&&(this.lightMap=e[t.lightMap]||null),t.lightMapIntensity!==void 0&&(this.lightMapIntensity=t.lightMapIntensity),t.aoMap!==void 0&&(this.aoMap=e[t.aoMap]||null),t.aoMapIntensity!==void 0&&(this.aoMapIntensity=t.aoMapIntensity),t.gradientMap!==void 0&&(this.gradientMap=e[t.gradientMap]||null),t.clearcoatMap!==void 0&&(this.clearcoatMap=e[t.clearcoatMap]||null),t.clearcoatRoughnessMap!==void 0&&(this.clearcoatRoughnessMap=e[t.clearcoatRoughnessMap]||null),t.clearcoatNormalMap!==void 0&&(this.clearcoatNormalMap=e[t.clearcoatNormalMap]||null),t.clearcoatNormalScale!==void 0&&(this.clearcoatNormalScale=new rt().fromArray(t.clearcoatNormalScale)),t.diffuseRoughnessMap!==void 0&&(this.diffuseRoughnessMap=e[t.diffuseRoughnessMap]||null),t.iridescenceMap!==void 0&&(this.iridescenceMap=e[t.iridescenceMap]||null),t.iridescenceThicknessMap!==void 0&&(this.iridescenceThicknessMap=e[t.iridescenceThicknessMap]||null),t.transmissionMap!==void 0&&(this.transmissionMap=e[t.transmissionMap]||null),t.thicknessMap!==void 0&&(this.thicknessMap=e[t.thicknessMap]||null),t.anisotropyMap!==void 0&&(this.anisotropyMap=e[t.anisotropyMap]||null),t.sheenColorMap!==void 0&&(this.sheenColorMap=e[t.sheenColorMap]||null),t.sheenRoughnessMap!==void 0&&(this.sheenRoughnessMap=e[t.sheenRoughnessMap]||null),this}clone(){return new this.constructor().copy(this)}copy(t){this.name=t.name,this.blending=t.blending,this.side=t.side,this.vertexColors=t.vertexColors,this.opacity=t.opacity,this.transparent=t.transparent,this.blendSrc=t.blendSrc,this.blendDst=t.blendDst,this.blendEquation=t.blendEquation,this.blendSrcAlpha=t.blendSrcAlpha,this.blendDstAlpha=t.blendDstAlpha,this.blendEquationAlpha=t.blendEquationAlpha,this.blendColor.copy(t.blendColor),this.blendAlpha=t.blendAlpha,this.depthFunc=t.depthFunc,this.depthTest=t.depthTest,this.depthWrite=t.depthWrite,this.stencilWriteMask=t.stencilWriteMask,this.stencilFunc=t.stencilFunc,this.stencilRef=t.stencilRef,this.stencilFuncMask=t.stencilFuncMask,this.stencilFail=t.stencilFail,this.stencilZFail=t.stencilZFail,this.stencilZPass=t.stencilZPass,this.stencilWrite=t.stencilWrite;let e=t.clippingPlanes,n=null;if(e!==null){let s=e.length;n=new Array(s);for(let r=0;r!==s;++r)n[r]=e[r].clone()}return this.clippingPlanes=n,this.clipIntersection=t.clipIntersection,this.clipShadows=t.clipShadows,this.shadowSide=t.shadowSide,this.colorWrite=t.colorWrite,this.precision=t.precision,this.polygonOffset=t.polygonOffset,this.polygonOffsetFactor=t.polygonOffsetFactor,this.polygonOffsetUnits=t.polygonOffsetUnits,this.dithering=t.dithering,this.alphaTest=t.alphaTest,this.alphaHash=t.alphaHash,this.alphaToCoverage=t.alphaToCoverage,this.premultipliedAlpha=t.premultipliedAlpha,this.forceSinglePass=t.forceSinglePass,this.allowOverride=t.allowOverride,this.visible=t.visible,this.toneMapped=t.toneMapped,this.userData=JSON.parse(JSON.stringify(t.userData)),this}dispose(){this.dispatchEvent({type:"dispose"})}set needsUpdate(t){t===!0&&this.version++}};var fi=new I,uh=new I,Zo=new I,Jo=new I,xi=class{constructor(t=new I,e=new I(0,0,-1)){this.origin=t,this.direction=e}set(t,e){return this.origin.copy(t),this.direction.copy(e),this}copy(t){return this.origin.copy(t.origin),this.direction.copy(t.direction),this}at(t,e){return e.copy(this.origin).addScaledVector(this.direction,t)}lookAt(t){return this.direction.copy(t).sub(this.origin).normalize(),this}recast(t){return this.origin.copy(this.at(t,fi)),this}closestPointToPoint(t,e){e.subVectors(t,this.origin);let n=e.dot(this.direction);return n<0?e.copy(this.origin):e.copy(this.origin).addScaledVector(this.direction,n)}distanceToPoint(t){return Math.sqrt(this.distanceSqToPoint(t))}distanceSqToPoint(t){let e=fi.subVectors(t,this.origin).dot(this.direction);return e<0?this.origin.distanceToSquared(t):(fi.copy(this.origin).addScaledVector(this.direction,e),fi.distanceToSquared(t))}distanceSqToSegment(t,e,n,s){uh.copy(t).add(e).multiplyScalar(.5),Zo.copy(e).sub(t).normalize(),Jo.copy(this.origin).sub(uh);let r=t.distanceTo(e)*.5,o=-this.direction.dot(Zo),a=Jo.dot(this.direction),l=-Jo.dot(Zo),c=Jo.lengthSq(),h=Math.abs(1-o*o),u,d,f,m;if(h>0)if(u=o*l-a,d=o*a-l,m=r*h,u>=0)if(d>=-m)if(d<=m){let x=1/h;u*=x,d*=x,f=u*(u+o*d+2*a)+d*(o*u+d+2*l)+c}else d=r,u=Math.max(0,-(o*d+a)),f=-u*u+d*(d+2*l)+c;else d=-r,u=Math.max(0,-(o*d+a)),f=-u*u+d*(d+2*l)+c;else d<=-m?(u=Math.max(0,-(-o*r+a)),d=u>0?-r:Math.min(Math.max(-r,-l),r),f=-u*u+d*(d+2*l)+c):d<=m?(u=0,d=Math.min(Math.max(-r,-l),r),f=d*(d+2*l)+c):(u=Math.max(0,-(o*r+a)),d=u>0?r:Math.min(Math.max(-r,-l),r),f=-u*u+d*(d+2*l)+c);else d=o>0?-r:r,u=Math.max(0,-(o*d+a)),f=-u*u+d*(d+2*l)+c;return n&&n.copy(this.origin).addScaledVector(this.direction,u),s&&s.copy(uh).addScaledVector(Zo,d),f}intersectSphere(t,e){if(t.radius<0)return null;fi.subVectors(t.center,this.origin);let n=fi.dot(this.direction),s=fi.dot(fi)-n*n,r=t.radius*t.radius;if(s>r)return null;let o=Math.sqrt(r-s),a=n-o,l=n+o;return l<0?null:a<0?this.at(l,e):this.at(a,e)}intersectsSphere(t){return t.radius<0?!1:this.distanceSqToPoint(t.center)<=t.radius*t.radius}distanceToPlane(t){let e=t.normal.dot(this.direction);if(e===0)return t.distanceToPoint(this.origin)===0?0:null;let n=-(this.origin.dot(t.normal)+t.constant)/e;return n>=0?n:null}intersectPlane(t,e){let n=this.distanceToPlane(t);return n===null?null:this.at(n,e)}intersectsPlane(t){let e=t.distanceToPoint(this.origin);return e===0||t.normal.dot(this.direction)*e<0}intersectBox(t,e){let n,s,r,o,a,l,c=1/this.direction.x,h=1/this.direction.y,u=1/this.direction.z,d=this.origin;return c>=0?(n=(t.min.x-d.x)*c,s=(t.max.x-d.x)*c):(n=(t.max.x-d.x)*c,s=(t.min.x-d.x)*c),h>=0?(r=(t.min.y-d.y)*h,o=(t.max.y-d.y)*h):(r=(t.max.y-d.y)*h,o=(t.min.y-d.y)*h),n>o||r>s||((r>n||isNaN(n))&&(n=r),(o<s||isNaN(s))&&(s=o),u>=0?(a=(t.min.z-d.z)*u,l=(t.max.z-d.z)*u):(a=(t.max.z-d.z)*u,l=(t.min.z-d.z)*u),n>l||a>s)||((a>n||n!==n)&&(n=a),(l<s||s!==s)&&(s=l),s<0)?null:this.at(n>=0?n:s,e)}intersectsBox(t){return this.intersectBox(t,fi)!==null}intersectTriangle(t,e,n,s,r){let o=this.origin,a=this.direction,l=a.x,c=a.y,h=a.z,u=t.x-o.x,d=t.y-o.y,f=t.z-o.z,m=e.x-o.x,x=e.y-o.y,p=e.z-o.z,g=n.x-o.x,y=n.y-o.y,w=n.z-o.z,S=Math.abs(l),T=Math.abs(c),A=Math.abs(h),_,E,O,P,U,G,$,L,V,X,z,nt;if(S>=T&&S>=A?(O=l,G=u,V=m,nt=g,l>=0?(_=c,E=h,P=d,U=f,$=x,L=p,X=y,z=w):(_=h,E=c,P=f,U=d,$=p,L=x,X=w,z=y)):T>=A?(O=c,G=d,V=x,nt=y,c>=0?(_=h,E=l,P=f,U=u,$=p,L=m,X=w,z=g):(_=l,E=h,P=u,U=f,$=m,L=p,X=g,z=w)):(O=h,G=f,V=p,nt=w,h>=0?(_=l,E=c,P=u,U=d,$=m,L=x,X=g,z=y):(_=c,E=l,P=d,U=u,$=x,L=m,X=y,z=g)),O===0)return null;let H=_/O,Q=E/O,et=1/O,Et=P-H*G,Nt=U-Q*G,Y=$-H*V,ht=L-Q*V,At=X-H*nt,Ot=z-Q*nt,vt=At*ht-Ot*Y,Bt=Et*Ot-Nt*At,ye=Y*Nt-ht*Et;if(s){if(vt<0||Bt<0||ye<0)return null}else if((vt<0||Bt<0||ye<0)&&(vt>0||Bt>0||ye>0))return null;let kt=vt+Bt+ye;if(kt===0)return null;let jt=et*(vt*G+Bt*V+ye*nt);return(kt>0?jt<0:jt>0)?null:this.at(jt/kt,r)}applyMatrix4(t){return this.origin.applyMatrix4(t),this.direction.transformDirection(t),this}equals(t){return t.origin.equals(this.origin)&&t.direction.equals(this.direction)}clone(){return new this.constructor().copy(this)}},vi=class extends _i{constructor(t){super(),this.isMeshBasicMaterial=!0,this.type="MeshBasicMaterial",this.color=new Yt(16777215),this.map=null,this.lightMap=null,this.lightMapIntensity=1,this.aoMap=null,this.aoMapIntensity=1,this.specularMap=null,this.alphaMap=null,this.envMap=null,this.envMapRotation=new Oi,this.combine=Oh,this.reflectivity=1,this.refractionRatio=.98,this.wireframe=!1,this.wireframeLinewidth=1,this.wireframeLinecap="round",this.wireframeLinejoin="round",this.fog=!0,this.setValues(t)}copy(t){return super.copy(t),this.color.copy(t.color),this.map=t.map,this.lightMap=t.lightMap,this.lightMapIntensity=t.lightMapIntensity,this.aoMap=t.aoMap,this.aoMapIntensity=t.aoMapIntensity,this.specularMap=t.specularMap,this.alphaMap=t.alphaMap,this.envMap=t.envMap,this.envMapRotation.copy(t.envMapRotation),this.combine=t.combine,this.reflectivity=t.reflectivity,this.refractionRatio=t.refractionRatio,this.wireframe=t.wireframe,this.wireframeLinewidth=t.wireframeLinewidth,this.wireframeLinecap=t.wireframeLinecap,this.wireframeLinejoin=t.wireframeLinejoin,this.fog=t.fog,this}},af=new ue,ts=new xi,jo=new jn,lf=new I,Ko=new I,Qo=new I,ta=new I,dh=new I,ea=new I,cf=new I,na=new I,Ee=class extends dn{constructor(t=new Se,e=new vi){super(),this.isMesh=!0,this.type="Mesh",this.geometry=t,this.material=e,this.morphTargetDictionary=void 0,this.morphTargetInfluences=void 0,this.count=1,this.updateMorphTargets()}copy(t,e){return super.copy(t,e),t.morphTargetInfluences!==void 0?this.morphTargetInfluences=t.morphTargetInfluences.slice():this.morphTargetInfluences=void 0,t.morphTargetDictionary!==void 0?this.morphTargetDictionary=Object.assign({},t.morphTargetDictionary):this.morphTargetDictionary=void 0,this.material=Array.isArray(t.material)?t.material.slice():t.material,this.geometry=t.geometry,this}updateMorphTargets(){let e=this.geometry.morphAttributes,n=Object.keys(e);if(n.length>0){let s=e[n[0]];if(s!==void 0){this.morphTargetInfluences=[],this.morphTargetDictionary={};for(let r=0,o=s.length;r<o;r++){let a=s[r].name||String(r);this.morphTargetInfluences.push(0),this.morphTargetDictionary[a]=r}}}}getVertexPosition(t,e){let n=this.geometry,s=n.attributes.position,r=n.morphAttributes.position,o=n.morphTargetsRelative;e.fromBufferAttribute(s,t);let a=this.morphTargetInfluences;if(r&&a){ea.set(0,0,0);for(let l=0,c=r.length;l<c;l++){let h=a[l],u=r[l];h!==0&&(dh.fromBufferAttribute(u,t),o?ea.addScaledVector(dh,h):ea.addScaledVector(dh.sub(e),h))}e.add(ea)}return e}intersectsFrustum(t){return t.intersectsObject(this)}raycast(t,e){let n=this.geometry,s=this.material,r=this.matrixWorld;s!==void 0&&(n.boundingSphere===null&&n.computeBoundingSphere(),jo.copy(n.boundingSphere),jo.applyMatrix4(r),ts.copy(t.ray).recast(t.near),!(jo.containsPoint(ts.origin)===!1&&(ts.intersectSphere(jo,lf)===null||ts.origin.distanceToSquared(lf)>(t.far-t.near)**2))&&(af.copy(r).invert(),ts.copy(t.ray).applyMatrix4(af),!(n.boundingBox!==null&&ts.intersectsBox(n.boundingBox)===!1)&&this._computeIntersections(t,e,ts)))}_computeIntersections(t,e,n){let s,r=this.geometry,o=this.material,a=r.index,l=r.attributes.position,c=r.attributes.uv,h=r.attributes.uv1,u=r.attributes.normal,d=r.groups,f=r.drawRange;if(a!==null)if(Array.isArray(o))for(let m=0,x=d.length;m<x;m++){let p=d[m],g=o[p.materialIndex],y=Math.max(p.start,f.start),w=Math.min(a.count,Math.min(p.start+p.count,f.start+f.count));for(let S=y,T=w;S<T;S+=3){let A=a.getX(S),_=a.getX(S+1),E=a.getX(S+2);s=ia(this,g,t,n,c,h,u,A,_,E),s&&(s.faceIndex=Math.floor(S/3),s.face.materialIndex=p.materialIndex,e.push(s))}}else{let m=Math.max(0,f.start),x=Math.min(a.count,f.start+f.count);for(let p=m,g=x;p<g;p+=3){let y=a.getX(p),w=a.getX(p+1),S=a.getX(p+2);s=ia(this,o,t,n,c,h,u,y,w,S),s&&(s.faceIndex=Math.floor(p/3),e.push(s))}}else if(l!==void 0)if(Array.isArray(o))for(let m=0,x=d.length;m<x;m++){let p=d[m],g=o[p.materialIndex],y=Math.max(p.start,f.start),w=Math.min(l.count,Math.min(p.start+p.count,f.start+f.count));for(let S=y,T=w;S<T;S+=3){let A=S,_=S+1,E=S+2;s=ia(this,g,t,n,c,h,u,A,_,E),s&&(s.faceIndex=Math.floor(S/3),s.face.materialIndex=p.materialIndex,e.push(s))}}else{let m=Math.max(0,f.start),x=Math.min(l.count,f.start+f.count);for(let p=m,g=x;p<g;p+=3){let y=p,w=p+1,S=p+2;s=ia(this,o,t,n,c,h,u,y,w,S),s&&(s.faceIndex=Math.floor(p/3),e.push(s))}}}};function $0(i,t,e,n,s,r,o,a){let l;if(t.side===Ge?l=n.intersectTriangle(o,r,s,!0,a):l=n.intersectTriangle(s,r,o,t.side===bn,a),l===null)return null;na.copy(a),na.applyMatrix4(i.matrixWorld);let c=e.ray.origin.distanceTo(na);return c<e.near||c>e.far?null:{distance:c,point:na.clone(),object:i}}function ia(i,t,e,n,s,r,o,a,l,c){i.getVertexPosition(a,Ko),i.getVertexPosition(l,Qo),i.getVertexPosition(c,ta);let h=$0(i,t,e,n,Ko,Qo,ta,cf);if(h){let u=new I;pi.getBarycoord(cf,Ko,Qo,ta,u),s&&(h.uv=pi.getInterpolatedAttribute(s,a,l,c,u,new rt)),r&&(h.uv1=pi.getInterpolatedAttribute(r,a,l,c,u,new rt)),o&&(h.normal=pi.getInterpolatedAttribute(o,a,l,c,u,new I),h.normal.dot(n.direction)>0&&h.normal.multiplyScalar(-1));let d={a,b:l,c,normal:new I,materialIndex:0};pi.getNormal(Ko,Qo,ta,d.normal),h.face=d,h.barycoord=u}return h}var is=class extends un{constructor(t=null,e=1,n=1,s,r,o,a,l,c=Ne,h=Ne,u,d){super(null,o,a,l,c,h,s,r,u,d),this.isDataTexture=!0,this.image={data:t,width:e,height:n},this.generateMipmaps=!1,this.flipY=!1,this.unpackAlignment=1}};var ss=class extends Ce{constructor(t,e,n,s=1){super(t,e,n),this.isInstancedBufferAttribute=!0,this.meshPerAttribute=s}copy(t){return super.copy(t),this.meshPerAttribute=t.meshPerAttribute,this}toJSON(){let t=super.toJSON();return t.meshPerAttribute=this.meshPerAttribute,t.isInstancedBufferAttribute=!0,t}},Cs=new ue,hf=new ue,sa=[],uf=new Jn,Y0=new ue,vr=new Ee,yr=new jn,Nr=class extends Ee{constructor(t,e,n){super(t,e),this.isInstancedMesh=!0,this.instanceMatrix=new ss(new Float32Array(n*16),16),this.instanceColor=null,this.morphTexture=null,this.count=n,this.boundingBox=null,this.boundingSphere=null;for(let s=0;s<n;s++)this.setMatrixAt(s,Y0)}computeBoundingBox(){let t=this.geometry,e=this.count;this.boundingBox===null&&(this.boundingBox=new Jn),t.boundingBox===null&&t.computeBoundingBox(),this.boundingBox.makeEmpty();for(let n=0;n<e;n++)this.getMatrixAt(n,Cs),uf.copy(t.boundingBox).applyMatrix4(Cs),this.boundingBox.union(uf)}computeBoundingSphere(){let t=this.geometry,e=this.count;this.boundingSphere===null&&(this.boundingSphere=new jn),t.boundingSphere===null&&t.computeBoundingSphere(),this.boundingSphere.makeEmpty();for(let n=0;n<e;n++)this.getMatrixAt(n,Cs),yr.copy(t.boundingSphere).applyMatrix4(Cs),this.boundingSphere.union(yr)}copy(t,e){return super.copy(t,e),this.instanceMatrix.copy(t.instanceMatrix),this.morphTexture=t.morphTexture!==null?t.morphTexture.clone():null,this.instanceColor=t.instanceColor!==null?t.instanceColor.clone():null,this.count=t.count,this.boundingBox=t.boundingBox!==null?t.boundingBox.clone():null,this.boundingSphere=t.boundingSphere!==null?t.boundingSphere.clone():null,this}getColorAt(t,e){return this.instanceColor===null?e.setRGB(1,1,1):e.fromArray(this.instanceColor.array,t*3)}getMatrixAt(t,e){return e.fromArray(this.instanceMatrix.array,t*16)}getMorphAt(t,e){let n=e.morphTargetInfluences,s=this.morphTexture.source.data.data,r=n.length+1,o=t*r+1;for(let a=0;a<n.length;a++)n[a]=s[o+a]}raycast(t,e){let n=this.matrixWorld,s=this.count;if(vr.geometry=this.geometry,vr.material=this.material,vr.material!==void 0&&(this.boundingSphere===null&&this.computeBoundingSphere(),yr.copy(this.boundingSphere),yr.applyMatrix4(n),t.ray.intersectsSphere(yr)!==!1))for(let r=0;r<s;r++){this.getMatrixAt(r,Cs),hf.multiplyMatrices(n,Cs),vr.matrixWorld=hf,vr.raycast(t,sa);for(let o=0,a=sa.length;o<a;o++){let l=sa[o];l.instanceId=r,l.object=this,e.push(l)}sa.length=0}}setColorAt(t,e){return this.instanceColor===null&&(this.instanceColor=new ss(new Float32Array(this.instanceMatrix.count*3).fill(1),3)),e.toArray(this.instanceColor.array,t*3),this}setMatrixAt(t,e){return e.toArray(this.instanceMatrix.array,t*16),this}setMorphAt(t,e){let n=e.morphTargetInfluences,s=n.length+1;this.morphTexture===null&&(this.morphTexture=new is(new Float32Array(s*this.count),s,this.count,ul,fn));let r=this.morphTexture.source.data.data,o=0;for(let c=0;c<n.length;c++)o+=n[c];let a=this.geometry.morphTargetsRelative?1:1-o,l=s*t;return r[l]=a,r.set(n,l+1),this}updateMorphTargets(){}dispose(){super.dispose(),this.instanceMatrix.dispose(),this.instanceColor!==null&&this.instanceColor.dispose(),this.morphTexture!==null&&(this.morphTexture.dispose(),this.morphTexture=null)}},es=new jn,Z0=new rt(.5,.5),ra=new I,rs=class{constructor(t=new xn,e=new xn,n=new xn,s=new xn,r=new xn,o=new xn){this.planes=[t,e,n,s,r,o]}set(t,e,n,s,r,o){let a=this.planes;return a[0].copy(t),a[1].copy(e),a[2].copy(n),a[3].copy(s),a[4].copy(r),a[5].copy(o),this}copy(t){let e=this.planes;for(let n=0;n<6;n++)e[n].copy(t.planes[n]);return this}setFromProjectionMatrix(t,e=Cn,n=!1){let s=this.planes,r=t.elements,o=r[0],a=r[1],l=r[2],c=r[3],h=r[4],u=r[5],d=r[6],f=r[7],m=r[8],x=r[9],p=r[10],g=r[11],y=r[12],w=r[13],S=r[14],T=r[15];if(s[0].setComponents(c-o,f-h,g-m,T-y).normalize(),s[1].setComponents(c+o,f+h,g+m,T+y).normalize(),s[2].setComponents(c+a,f+u,g+x,T+w).normalize(),s[3].setComponents(c-a,f-u,g-x,T-w).normalize(),n)s[4].setComponents(l,d,p,S).normalize(),s[5].setComponents(c-l,f-d,g-p,T-S).normalize();else if(s[4].setComponents(c-l,f-d,g-p,T-S).normalize(),e===Cn)s[5].setComponents(c+l,f+d,g+p,T+S).normalize();else if(e===Rr)s[5].setComponents(l,d,p,S).normalize();else throw new Error("THREE.Frustum.setFromProjectionMatrix(): Invalid coordinate system: "+e);return this}intersectsObject(t){if(t.boundingSphere!==void 0)t.boundingSphere===null&&t.computeBoundingSphere(),es.copy(t.boundingSphere).applyMatrix4(t.matrixWorld);else{let e=t.geometry;e.boundingSphere===null&&e.computeBoundingSphere(),es.copy(e.boundingSphere).applyMatrix4(t.matrixWorld)}return this.intersectsSphere(es)}intersectsSprite(t){es.center.set(0,0,0);let e=Z0.distanceTo(t.center);return es.radius=.7071067811865476+e,es.applyMatrix4(t.matrixWorld),this.intersectsSphere(es)}intersectsSphere(t){let e=this.planes,n=t.center,s=-t.radius;for(let r=0;r<6;r++)if(e[r].distanceToPoint(n)<s)return!1;return!0}intersectsBox(t){let e=this.planes;for(let n=0;n<6;n++){let s=e[n];if(ra.x=s.normal.x>0?t.max.x:t.min.x,ra.y=s.normal.y>0?t.max.y:t.min.y,ra.z=s.normal.z>0?t.max.z:t.min.z,s.distanceToPoint(ra)<0)return!1}return!0}containsPoint(t){let e=this.planes;for(let n=0;n<6;n++)if(e[n].distanceToPoint(t)<0)return!1;return!0}clone(){return new this.constructor().copy(this)}},df=new ue,La=class i{constructor(){this.coordinateSystem=Cn,this._frustums=[],this._count=0}setFromArrayCamera(t){let e=t.cameras,n=this._frustums;for(let s=0;s<e.length;s++){let r=e[s];df.multiplyMatrices(r.projectionMatrix,r.matrixWorldInverse),n[s]===void 0&&(n[s]=new rs),n[s].setFromProjectionMatrix(df,r.coordinateSystem,r.reversedDepth)}return this._count=e.length,this}getFrustum(t){return this._frustums[t]}intersectsObject(t){let e=this._frustums;for(let n=0;n<this._count;n++)if(e[n].intersectsObject(t))return!0;return!1}intersectsSprite(t){let e=this._frustums;for(let n=0;n<this._count;n++)if(e[n].intersectsSprite(t))return!0;return!1}intersectsSphere(t){let e=this._frustums;for(let n=0;n<this._count;n++)if(e[n].intersectsSphere(t))return!0;return!1}intersectsBox(t){let e=this._frustums;for(let n=0;n<this._count;n++)if(e[n].intersectsBox(t))return!0;return!1}containsPoint(t){let e=this._frustums;for(let n=0;n<this._count;n++)if(e[n].containsPoint(t))return!0;return!1}copy(t){this.coordinateSystem=t.coordinateSystem;let e=this._frustums,n=t._frustums;for(let s=0;s<t._count;s++)e[s]===void 0&&(e[s]=new rs),e[s].copy(n[s]);return this._count=t._count,this}clone(){return new i().copy(this)}};var Kn=class extends _i{constructor(t){super(),this.isLineBasicMaterial=!0,this.type="LineBasicMaterial",this.color=new Yt(16777215),this.map=null,this.linewidth=1,this.linecap="round",this.linejoin="round",this.fog=!0,this.setValues(t)}copy(t){return super.copy(t),this.color.copy(t.color),this.map=t.map,this.linewidth=t.linewidth,this.linecap=t.linecap,this.linejoin=t.linejoin,this.fog=t.fog,this}},Da=new I,Na=new I,ff=new ue,br=new xi,oa=new jn,fh=new I,pf=new I,Ua=class extends dn{constructor(t=new Se,e=new Kn){super(),this.isLine=!0,this.type="Line",this.geometry=t,this.material=e,this.morphTargetDictionary=void 0,this.morphTargetInfluences=void 0,this.updateMorphTargets()}copy(t,e){return super.copy(t,e),t.morphTargetInfluences!==void 0?this.morphTargetInfluences=t.morphTargetInfluences.slice():this.morphTargetInfluences=void 0,t.morphTargetDictionary!==void 0?this.morphTargetDictionary=Object.assign({},t.morphTargetDictionary):this.morphTargetDictionary=void 0,this.material=Array.isArray(t.material)?t.material.slice():t.material,this.geometry=t.geometry,this}computeLineDistances(){let t=this.geometry;if(t.index===null){let e=t.attributes.position,n=[0];for(let s=1,r=e.count;s<r;s++)Da.fromBufferAttribute(e,s-1),Na.fromBufferAttribute(e,s),n[s]=n[s-1],n[s]+=Da.distanceTo(Na);t.setAttribute("lineDistance",new ze(n,1))}else Vt("Line.computeLineDistances(): Computation only possible with non-indexed BufferGeometry.");return this}intersectsFrustum(t){return t.intersectsObject(this)}raycast(t,e){let n=this.geometry,s=this.matrixWorld,r=t.params.Line.threshold,o=n.drawRange;if(n.boundingSphere===null&&n.computeBoundingSphere(),oa.copy(n.boundingSphere),oa.applyMatrix4(s),oa.radius+=r,t.ray.intersectsSphere(oa)===!1)return;ff.copy(s).invert(),br.copy(t.ray).applyMatrix4(ff);let a=r/((this.scale.x+this.scale.y+this.scale.z)/3),l=a*a,c=this.isLineSegments?2:1,h=n.index,d=n.attributes.position;if(h!==null){let f=Math.max(0,o.start),m=Math.min(h.count,o.start+o.count);for(let x=f,p=m-1;x<p;x+=c){let g=h.getX(x),y=h.getX(x+1),w=aa(this,t,br,l,g,y,x);w&&e.push(w)}if(this.isLineLoop){let x=h.getX(m-1),p=h.getX(f),g=aa(this,t,br,l,x,p,m-1);g&&e.push(g)}}else{let f=Math.max(0,o.start),m=Math.min(d.count,o.start+o.count);for(let x=f,p=m-1;x<p;x+=c){let g=aa(this,t,br,l,x,x+1,x);g&&e.push(g)}if(this.isLineLoop){let x=aa(this,t,br,l,m-1,f,m-1);x&&e.push(x)}}}updateMorphTargets(){let e=this.geometry.morphAttributes,n=Object.keys(e);if(n.length>0){let s=e[n[0]];if(s!==void 0){this.morphTargetInfluences=[],this.morphTargetDictionary={};for(let r=0,o=s.length;r<o;r++){let a=s[r].name||String(r);this.morphTargetInfluences.push(0),this.morphTargetDictionary[a]=r}}}}};function aa(i,t,e,n,s,r,o){let a=i.geometry.attributes.position;if(Da.fromBufferAttribute(a,s),Na.fromBufferAttribute(a,r),e.distanceSqToSegment(Da,Na,fh,pf)>n)return;fh.applyMatrix4(i.matrixWorld);let c=t.ray.origin.distanceTo(fh);if(!(c<t.near||c>t.far))return{distance:c,point:pf.clone().applyMatrix4(i.matrixWorld),index:o,face:null,faceIndex:null,barycoord:null,object:i}}var mf=new I,gf=new I,Rn=class extends Ua{constructor(t,e){super(t,e),this.isLineSegments=!0,this.type="LineSegments"}computeLineDistances(){let t=this.geometry;if(t.index===null){let e=t.attributes.position,n=[];for(let s=0,r=e.count;s<r;s+=2)mf.fromBufferAttribute(e,s),gf.fromBufferAttribute(e,s+1),n[s]=s===0?0:n[s-1],n[s+1]=n[s]+mf.distanceTo(gf);t.setAttribute("lineDistance",new ze(n,1))}else Vt("LineSegments.computeLineDistances(): Computation only possible with non-indexed BufferGeometry.");return this}};var Oa=class extends _i{constructor(t){super(),this.isPointsMaterial=!0,this.type="PointsMaterial",this.color=new Yt(16777215),this.map=null,this.alphaMap=null,this.size=1,this.sizeAttenuation=!0,this.fog=!0,this.setValues(t)}copy(t){return super.copy(t),this.color.copy(t.color),this.map=t.map,this.alphaMap=t.alphaMap,this.size=t.size,this.sizeAttenuation=t.sizeAttenuation,this.fog=t.fog,this}},_f=new ue,Mh=new xi,la=new jn,ca=new I,Ur=class extends dn{constructor(t=new Se,e=new Oa){super(),this.isPoints=!0,this.type="Points",this.geometry=t,this.material=e,this.morphTargetDictionary=void 0,this.morphTargetInfluences=void 0,this.updateMorphTargets()}copy(t,e){return super.copy(t,e),t.morphTargetInfluences!==void 0?this.morphTargetInfluences=t.morphTargetInfluences.slice():this.morphTargetInfluences=void 0,t.morphTargetDictionary!==void 0?this.morphTargetDictionary=Object.assign({},t.morphTargetDictionary):this.morphTargetDictionary=void 0,this.material=Array.isArray(t.material)?t.material.slice():t.material,this.geometry=t.geometry,this}intersectsFrustum(t){return t.intersectsObject(this)}raycast(t,e){let n=this.geometry,s=this.matrixWorld,r=t.params.Points.threshold,o=n.drawRange;if(n.boundingSphere===null&&n.computeBoundingSphere(),la.copy(n.boundingSphere),la.applyMatrix4(s),la.radius+=r,t.ray.intersectsSphere(la)===!1)return;_f.copy(s).invert(),Mh.copy(t.ray).applyMatrix4(_f);let a=r/((this.scale.x+this.scale.y+this.scale.z)/3),l=a*a,c=n.index,u=n.attributes.position;if(c!==null){let d=Math.max(0,o.start),f=Math.min(c.count,o.start+o.count);for(let m=d,x=f;m<x;m++){let p=c.getX(m);ca.fromBufferAttribute(u,p),xf(ca,p,l,s,t,e,this)}}else{let d=Math.max(0,o.start),f=Math.min(u.count,o.start+o.count);for(let m=d,x=f;m<x;m++)ca.fromBufferAttribute(u,m),xf(ca,m,l,s,t,e,this)}}updateMorphTargets(){let e=this.geometry.morphAttributes,n=Object.keys(e);if(n.length>0){let s=e[n[0]];if(s!==void 0){this.morphTargetInfluences=[],this.morphTargetDictionary={};for(let r=0,o=s.length;r<o;r++){let a=s[r].name||String(r);this.morphTargetInfluences.push(0),this.morphTargetDictionary[a]=r}}}}};function xf(i,t,e,n,s,r,o){let a=Mh.distanceSqToPoint(i);if(a<e){let l=new I;Mh.closestPointToPoint(i,l),l.applyMatrix4(n);let c=s.ray.origin.distanceTo(l);if(c<s.near||c>s.far)return;r.push({distance:c,distanceToRay:Math.sqrt(a),point:l,index:t,face:null,faceIndex:null,barycoord:null,object:o})}}var Or=class extends un{constructor(t=[],e=cs,n,s,r,o,a,l,c,h){super(t,e,n,s,r,o,a,l,c,h),this.isCubeTexture=!0,this.flipY=!1}get images(){return this.image}set images(t){this.image=t}};var yi=class extends un{constructor(t,e,n=kn,s,r,o,a=Ne,l=Ne,c,h=gi,u=1){if(h!==gi&&h!==Mi)throw new Error("THREE.DepthTexture: format must be either THREE.DepthFormat or THREE.DepthStencilFormat");let d={width:t,height:e,depth:u};super(d,s,r,o,a,l,h,n,c),this.isDepthTexture=!0,this.flipY=!1,this.generateMipmaps=!1,this.compareFunction=null}copy(t){return super.copy(t),this.source=new Bs(Object.assign({},t.image)),this.compareFunction=t.compareFunction,this}toJSON(t){let e=super.toJSON(t);return e.compareFunction=this.compareFunction,e}},Fr=class extends yi{constructor(t,e=kn,n=cs,s,r,o=Ne,a=Ne,l,c=gi){let h={width:t,height:t,depth:1},u=[h,h,h,h,h,h];super(t,t,e,n,s,r,o,a,l,c),this.image=u,this.isCubeDepthTexture=!0,this.isCubeTexture=!0}get images(){return this.image}set images(t){this.image=t}},Br=class extends un{constructor(t=null){super(),this.sourceTexture=t,this.isExternalTexture=!0}copy(t){return super.copy(t),this.sourceTexture=t.sourceTexture,this}},Vs=class i extends Se{constructor(t=1,e=1,n=1,s=1,r=1,o=1){super(),this.type="BoxGeometry",this.parameters={width:t,height:e,depth:n,widthSegments:s,heightSegments:r,depthSegments:o};let a=this;s=Math.floor(s),r=Math.floor(r),o=Math.floor(o);let l=[],c=[],h=[],u=[],d=0,f=0;m("z","y","x",-1,-1,n,e,t,o,r,0),m("z","y","x",1,-1,n,e,-t,o,r,1),m("x","z","y",1,1,t,n,e,s,o,2),m("x","z","y",1,-1,t,n,-e,s,o,3),m("x","y","z",1,-1,t,e,n,s,r,4),m("x","y","z",-1,-1,t,e,-n,s,r,5),this.setIndex(l),this.setAttribute("position",new ze(c,3)),this.setAttribute("normal",new ze(h,3)),this.setAttribute("uv",new ze(u,2));function m(x,p,g,y,w,S,T,A,_,E,O){let P=S/_,U=T/E,G=S/2,$=T/2,L=A/2,V=_+1,X=E+1,z=0,nt=0,H=new I;for(let Q=0;Q<X;Q++){let et=Q*U-$;for(let Et=0;Et<V;Et++){let Nt=Et*P-G;H[x]=Nt*y,H[p]=et*w,H[g]=L,c.push(H.x,H.y,H.z),H[x]=0,H[p]=0,H[g]=A>0?1:-1,h.push(H.x,H.y,H.z),u.push(Et/_),u.push(1-Q/E),z+=1}}for(let Q=0;Q<E;Q++)for(let et=0;et<_;et++){let Et=d+et+V*Q,Nt=d+et+V*(Q+1),Y=d+(et+1)+V*(Q+1),ht=d+(et+1)+V*Q;l.push(Et,Nt,ht),l.push(Nt,Y,ht),nt+=6}a.addGroup(f,nt,O),f+=nt,d+=z}}copy(t){return super.copy(t),this.parameters=Object.assign({},t.parameters),this}static fromJSON(t){return new i(t.width,t.height,t.depth,t.widthSegments,t.heightSegments,t.depthSegments)}};var ha=new I,ua=new I,ph=new I,da=new pi,kr=class extends Se{constructor(t=null,e=1){if(super(),this.type="EdgesGeometry",this.parameters={geometry:t,thresholdAngle:e},t!==null){let s=Math.pow(10,4),r=Math.cos(Ds*e),o=t.getIndex(),a=t.getAttribute("position"),l=o?o.count:a.count,c=[0,0,0],h=["a","b","c"],u=new Array(3),d=new Map,f=[];for(let m=0;m<l;m+=3){o?(c[0]=o.getX(m),c[1]=o.getX(m+1),c[2]=o.getX(m+2)):(c[0]=m,c[1]=m+1,c[2]=m+2);let{a:x,b:p,c:g}=da;if(x.fromBufferAttribute(a,c[0]),p.fromBufferAttribute(a,c[1]),g.fromBufferAttribute(a,c[2]),da.getNormal(ph),u[0]=`${Math.round(x.x*s)},${Math.round(x.y*s)},${Math.round(x.z*s)}`,u[1]=`${Math.round(p.x*s)},${Math.round(p.y*s)},${Math.round(p.z*s)}`,u[2]=`${Math.round(g.x*s)},${Math.round(g.y*s)},${Math.round(g.z*s)}`,!(u[0]===u[1]||u[1]===u[2]||u[2]===u[0]))for(let y=0;y<3;y++){let w=(y+1)%3,S=u[y],T=u[w],A=da[h[y]],_=da[h[w]],E=`${S}_${T}`,O=`${T}_${S}`,P=d.get(O);P?(ph.dot(P.normal)<=r&&(f.push(A.x,A.y,A.z),f.push(_.x,_.y,_.z)),d.set(O,null)):d.has(E)||d.set(E,{index0:c[y],index1:c[w],normal:ph.clone()})}}for(let m of d.values())if(m){let{index0:x,index1:p}=m;ha.fromBufferAttribute(a,x),ua.fromBufferAttribute(a,p),f.push(ha.x,ha.y,ha.z),f.push(ua.x,ua.y,ua.z)}this.setAttribute("position",new ze(f,3))}}copy(t){return super.copy(t),this.parameters=Object.assign({},t.parameters),this}},vn=class{constructor(){this.type="Curve",this.arcLengthDivisions=200,this.needsUpdate=!1,this.cacheArcLengths=null}getPoint(){Vt("Curve: .getPoint() not implemented.")}getPointAt(t,e){let n=this.getUtoTmapping(t);return this.getPoint(n,e)}getPoints(t=5){let e=[];for(let n=0;n<=t;n++)e.push(this.getPoint(n/t));return e}getSpacedPoints(t=5){let e=[];for(let n=0;n<=t;n++)e.push(this.getPointAt(n/t));return e}getLength(){let t=this.getLengths();return t[t.length-1]}getLengths(t=this.arcLengthDivisions){if(this.cacheArcLengths&&this.cacheArcLengths.length===t+1&&!this.needsUpdate)return this.cacheArcLengths;this.needsUpdate=!1;let e=[],n,s=this.getPoint(0),r=0;e.push(0);for(let o=1;o<=t;o++)n=this.getPoint(o/t),r+=n.distanceTo(s),e.push(r),s=n;return this.cacheArcLengths=e,e}updateArcLengths(){this.needsUpdate=!0,this.getLengths()}getUtoTmapping(t,e=null){let n=this.getLengths(),s=0,r=n.length,o;e?o=e:o=t*n[r-1];let a=0,l=r-1,c;for(;a<=l;)if(s=Math.floor(a+(l-a)/2),c=n[s]-o,c<0)a=s+1;else if(c>0)l=s-1;else{l=s;break}if(s=l,n[s]===o)return s/(r-1);let h=n[s],d=n[s+1]-h,f=(o-h)/d;return(s+f)/(r-1)}getTangent(t,e){let s=t-1e-4,r=t+1e-4;s<0&&(s=0),r>1&&(r=1);let o=this.getPoint(s),a=this.getPoint(r),l=e||(o.isVector2?new rt:new I);return l.copy(a).sub(o).normalize(),l}getTangentAt(t,e){let n=this.getUtoTmapping(t);return this.getTangent(n,e)}computeFrenetFrames(t,e=!1){let n=new I,s=[],r=[],o=[],a=new I,l=new ue;for(let f=0;f<=t;f++){let m=f/t;s[f]=this.getTangentAt(m,new I)}r[0]=new I,o[0]=new I;let c=Number.MAX_VALUE,h=Math.abs(s[0].x),u=Math.abs(s[0].y),d=Math.abs(s[0].z);h<=c&&(c=h,n.set(1,0,0)),u<=c&&(c=u,n.set(0,1,0)),d<=c&&n.set(0,0,1),a.crossVectors(s[0],n).normalize(),r[0].crossVectors(s[0],a),o[0].crossVectors(s[0],r[0]);for(let f=1;f<=t;f++){if(r[f]=r[f-1].clone(),o[f]=o[f-1].clone(),a.crossVectors(s[f-1],s[f]),a.length()>Number.EPSILON){a.normalize();let m=Math.acos(ee(s[f-1].dot(s[f]),-1,1));r[f].applyMatrix4(l.makeRotationAxis(a,m))}o[f].crossVectors(s[f],r[f])}if(e===!0){let f=Math.acos(ee(r[0].dot(r[t]),-1,1));f/=t,s[0].dot(a.crossVectors(r[0],r[t]))>0&&(f=-f);for(let m=1;m<=t;m++)r[m].applyMatrix4(l.makeRotationAxis(s[m],f*m)),o[m].crossVectors(s[m],r[m])}return{tangents:s,normals:r,binormals:o}}clone(){return new this.constructor().copy(this)}copy(t){return this.arcLengthDivisions=t.arcLengthDivisions,this.cacheArcLengths=null,this}toJSON(){let t={metadata:{version:4.7,type:"Curve",generator:"Curve.toJSON"}};return t.arcLengthDivisions=this.arcLengthDivisions,t.type=this.type,t}fromJSON(t){return this.arcLengthDivisions=t.arcLengthDivisions,this.cacheArcLengths=null,this}},Hs=class extends vn{constructor(t=0,e=0,n=1,s=1,r=0,o=Math.PI*2,a=!1,l=0){super(),this.isEllipseCurve=!0,this.type="EllipseCurve",this.aX=t,this.aY=e,this.xRadius=n,this.yRadius=s,this.aStartAngle=r,this.aEndAngle=o,this.aClockwise=a,this.aRotation=l}getPoint(t,e=new rt){let n=e,s=Math.PI*2,r=this.aEndAngle-this.aStartAngle,o=Math.abs(r)<Number.EPSILON;for(;r<0;)r+=s;for(;r>s;)r-=s;r<Number.EPSILON&&(o?r=0:r=s),this.aClockwise===!0&&!o&&(r===s?r=-s:r=r-s);let a=this.aStartAngle+t*r,l=this.aX+this.xRadius*Math.cos(a),c=this.aY+this.yRadius*Math.sin(a);if(this.aRotation!==0){let h=Math.cos(this.aRotation),u=Math.sin(this.aRotation),d=l-this.aX,f=c-this.aY;l=d*h-f*u+this.aX,c=d*u+f*h+this.aY}return n.set(l,c)}copy(t){return super.copy(t),this.aX=t.aX,this.aY=t.aY,this.xRadius=t.xRadius,this.yRadius=t.yRadius,this.aStartAngle=t.aStartAngle,this.aEndAngle=t.aEndAngle,this.aClockwise=t.aClockwise,this.aRotation=t.aRotation,this}toJSON(){let t=super.toJSON();return t.aX=this.aX,t.aY=this.aY,t.xRadius=this.xRadius,t.yRadius=this.yRadius,t.aStartAngle=this.aStartAngle,t.aEndAngle=this.aEndAngle,t.aClockwise=this.aClockwise,t.aRotation=this.aRotation,t}fromJSON(t){return super.fromJSON(t),this.aX=t.aX,this.aY=t.aY,this.xRadius=t.xRadius,this.yRadius=t.yRadius,this.aStartAngle=t.aStartAngle,this.aEndAngle=t.aEndAngle,this.aClockwise=t.aClockwise,this.aRotation=t.aRotation,this}},Fa=class extends Hs{constructor(t,e,n,s,r,o){super(t,e,n,n,s,r,o),this.isArcCurve=!0,this.type="ArcCurve"}};function cu(){let i=0,t=0,e=0,n=0;function s(r,o,a,l){i=r,t=a,e=-3*r+3*o-2*a-l,n=2*r-2*o+a+l}return{initCatmullRom:function(r,o,a,l,c){s(o,a,c*(a-r),c*(l-o))},initNonuniformCatmullRom:function(r,o,a,l,c,h,u){let d=(o-r)/c-(a-r)/(c+h)+(a-o)/h,f=(a-o)/h-(l-o)/(h+u)+(l-a)/u;d*=h,f*=h,s(o,a,d,f)},calc:function(r){let o=r*r,a=o*r;return i+t*r+e*o+n*a}}}var vf=new I,yf=new I,mh=new cu,gh=new cu,_h=new cu,Ba=class extends vn{constructor(t=[],e=!1,n="centripetal",s=.5){super(),this.isCatmullRomCurve3=!0,this.type="CatmullRomCurve3",this.points=t,this.closed=e,this.curveType=n,this.tension=s}getPoint(t,e=new I){let n=e,s=this.points,r=s.length,o=(r-(this.closed?0:1))*t,a=Math.floor(o),l=o-a;this.closed?a+=a>0?0:(Math.floor(Math.abs(a)/r)+1)*r:l===0&&a===r-1&&(a=r-2,l=1);let c,h;this.closed||a>0?c=s[(a-1)%r]:(yf.subVectors(s[0],s[1]).add(s[0]),c=yf);let u=s[a%r],d=s[(a+1)%r];if(this.closed||a+2<r?h=s[(a+2)%r]:(vf.subVectors(s[r-1],s[r-2]).add(s[r-1]),h=vf),this.curveType==="centripetal"||this.curveType==="chordal"){let f=this.curveType==="chordal"?.5:.25,m=Math.pow(c.distanceToSquared(u),f),x=Math.pow(u.distanceToSquared(d),f),p=Math.pow(d.distanceToSquared(h),f);x<1e-4&&(x=1),m<1e-4&&(m=x),p<1e-4&&(p=x),mh.initNonuniformCatmullRom(c.x,u.x,d.x,h.x,m,x,p),gh.initNonuniformCatmullRom(c.y,u.y,d.y,h.y,m,x,p),_h.initNonuniformCatmullRom(c.z,u.z,d.z,h.z,m,x,p)}else this.curveType==="catmullrom"&&(mh.initCatmullRom(c.x,u.x,d.x,h.x,this.tension),gh.initCatmullRom(c.y,u.y,d.y,h.y,this.tension),_h.initCatmullRom(c.z,u.z,d.z,h.z,this.tension));return n.set(mh.calc(l),gh.calc(l),_h.calc(l)),n}copy(t){super.copy(t),this.points=[];for(let e=0,n=t.points.length;e<n;e++){let s=t.points[e];this.points.push(s.clone())}return this.closed=t.closed,this.curveType=t.curveType,this.tension=t.tension,this}toJSON(){let t=super.toJSON();t.points=[];for(let e=0,n=this.points.length;e<n;e++){let s=this.points[e];t.points.push(s.toArray())}return t.closed=this.closed,t.curveType=this.curveType,t.tension=this.tension,t}fromJSON(t){super.fromJSON(t),this.points=[];for(let e=0,n=t.points.length;e<n;e++){let s=t.points[e];this.points.push(new I().fromArray(s))}return this.closed=t.closed,this.curveType=t.curveType,this.tension=t.tension,this}};function bf(i,t,e,n,s){let r=(n-t)*.5,o=(s-e)*.5,a=i*i,l=i*a;return(2*e-2*n+r+o)*l+(-3*e+3*n-2*r-o)*a+r*i+e}function J0(i,t){let e=1-i;return e*e*t}function j0(i,t){return 2*(1-i)*i*t}function K0(i,t){return i*i*t}function Er(i,t,e,n){return J0(i,t)+j0(i,e)+K0(i,n)}function Q0(i,t){let e=1-i;return e*e*e*t}function t_(i,t){let e=1-i;return 3*e*e*i*t}function e_(i,t){return 3*(1-i)*i*i*t}function n_(i,t){return i*i*i*t}function Ar(i,t,e,n,s){return Q0(i,t)+t_(i,e)+e_(i,n)+n_(i,s)}var zr=class extends vn{constructor(t=new rt,e=new rt,n=new rt,s=new rt){super(),this.isCubicBezierCurve=!0,this.type="CubicBezierCurve",this.v0=t,this.v1=e,this.v2=n,this.v3=s}getPoint(t,e=new rt){let n=e,s=this.v0,r=this.v1,o=this.v2,a=this.v3;return n.set(Ar(t,s.x,r.x,o.x,a.x),Ar(t,s.y,r.y,o.y,a.y)),n}copy(t){return super.copy(t),this.v0.copy(t.v0),this.v1.copy(t.v1),this.v2.copy(t.v2),this.v3.copy(t.v3),this}toJSON(){let t=super.toJSON();return t.v0=this.v0.toArray(),t.v1=this.v1.toArray(),t.v2=this.v2.toArray(),t.v3=this.v3.toArray(),t}fromJSON(t){return super.fromJSON(t),this.v0.fromArray(t.v0),this.v1.fromArray(t.v1),this.v2.fromArray(t.v2),this.v3.fromArray(t.v3),this}},ka=class extends vn{constructor(t=new I,e=new I,n=new I,s=new I){super(),this.isCubicBezierCurve3=!0,this.type="CubicBezierCurve3",this.v0=t,this.v1=e,this.v2=n,this.v3=s}getPoint(t,e=new I){let n=e,s=this.v0,r=this.v1,o=this.v2,a=this.v3;return n.set(Ar(t,s.x,r.x,o.x,a.x),Ar(t,s.y,r.y,o.y,a.y),Ar(t,s.z,r.z,o.z,a.z)),n}copy(t){return super.copy(t),this.v0.copy(t.v0),this.v1.copy(t.v1),this.v2.copy(t.v2),this.v3.copy(t.v3),this}toJSON(){let t=super.toJSON();return t.v0=this.v0.toArray(),t.v1=this.v1.toArray(),t.v2=this.v2.toArray(),t.v3=this.v3.toArray(),t}fromJSON(t){return super.fromJSON(t),this.v0.fromArray(t.v0),this.v1.fromArray(t.v1),this.v2.fromArray(t.v2),this.v3.fromArray(t.v3),this}},Gr=class extends vn{constructor(t=new rt,e=new rt){super(),this.isLineCurve=!0,this.type="LineCurve",this.v1=t,this.v2=e}getPoint(t,e=new rt){let n=e;return t===1?n.copy(this.v2):(n.copy(this.v2).sub(this.v1),n.multiplyScalar(t).add(this.v1)),n}getPointAt(t,e){return this.getPoint(t,e)}getTangent(t,e=new rt){return e.subVectors(this.v2,this.v1).normalize()}getTangentAt(t,e){return this.getTangent(t,e)}copy(t){return super.copy(t),this.v1.copy(t.v1),this.v2.copy(t.v2),this}toJSON(){let t=super.toJSON();return t.v1=this.v1.toArray(),t.v2=this.v2.toArray(),t}fromJSON(t){return super.fromJSON(t),this.v1.fromArray(t.v1),this.v2.fromArray(t.v2),this}},za=class extends vn{constructor(t=new I,e=new I){super(),this.isLineCurve3=!0,this.type="LineCurve3",this.v1=t,this.v2=e}getPoint(t,e=new I){let n=e;return t===1?n.copy(this.v2):(n.copy(this.v2).sub(this.v1),n.multiplyScalar(t).add(this.v1)),n}getPointAt(t,e){return this.getPoint(t,e)}getTangent(t,e=new I){return e.subVectors(this.v2,this.v1).normalize()}getTangentAt(t,e){return this.getTangent(t,e)}copy(t){return super.copy(t),this.v1.copy(t.v1),this.v2.copy(t.v2),this}toJSON(){let t=super.toJSON();return t.v1=this.v1.toArray(),t.v2=this.v2.toArray(),t}fromJSON(t){return super.fromJSON(t),this.v1.fromArray(t.v1),this.v2.fromArray(t.v2),this}},Vr=class extends vn{constructor(t=new rt,e=new rt,n=new rt){super(),this.isQuadraticBezierCurve=!0,this.type="QuadraticBezierCurve",this.v0=t,this.v1=e,this.v2=n}getPoint(t,e=new rt){let n=e,s=this.v0,r=this.v1,o=this.v2;return n.set(Er(t,s.x,r.x,o.x),Er(t,s.y,r.y,o.y)),n}copy(t){return super.copy(t),this.v0.copy(t.v0),this.v1.copy(t.v1),this.v2.copy(t.v2),this}toJSON(){let t=super.toJSON();return t.v0=this.v0.toArray(),t.v1=this.v1.toArray(),t.v2=this.v2.toArray(),t}fromJSON(t){return super.fromJSON(t),this.v0.fromArray(t.v0),this.v1.fromArray(t.v1),this.v2.fromArray(t.v2),this}},Ga=class extends vn{constructor(t=new I,e=new I,n=new I){super(),this.isQuadraticBezierCurve3=!0,this.type="QuadraticBezierCurve3",this.v0=t,this.v1=e,this.v2=n}getPoint(t,e=new I){let n=e,s=this.v0,r=this.v1,o=this.v2;return n.set(Er(t,s.x,r.x,o.x),Er(t,s.y,r.y,o.y),Er(t,s.z,r.z,o.z)),n}copy(t){return super.copy(t),this.v0.copy(t.v0),this.v1.copy(t.v1),this.v2.copy(t.v2),this}toJSON(){let t=super.toJSON();return t.v0=this.v0.toArray(),t.v1=this.v1.toArray(),t.v2=this.v2.toArray(),t}fromJSON(t){return super.fromJSON(t),this.v0.fromArray(t.v0),this.v1.fromArray(t.v1),this.v2.fromArray(t.v2),this}},Hr=class extends vn{constructor(t=[]){super(),this.isSplineCurve=!0,this.type="SplineCurve",this.points=t}getPoint(t,e=new rt){let n=e,s=this.points,r=(s.length-1)*t,o=Math.floor(r),a=r-o,l=s[o===0?o:o-1],c=s[o],h=s[o>s.length-2?s.length-1:o+1],u=s[o>s.length-3?s.length-1:o+2];return n.set(bf(a,l.x,c.x,h.x,u.x),bf(a,l.y,c.y,h.y,u.y)),n}copy(t){super.copy(t),this.points=[];for(let e=0,n=t.points.length;e<n;e++){let s=t.points[e];this.points.push(s.clone())}return this}toJSON(){let t=super.toJSON();t.points=[];for(let e=0,n=this.points.length;e<n;e++){let s=this.points[e];t.points.push(s.toArray())}return t}fromJSON(t){super.fromJSON(t),this.points=[];for(let e=0,n=t.points.length;e<n;e++){let s=t.points[e];this.points.push(new rt().fromArray(s))}return this}},Sh=Object.freeze({__proto__:null,ArcCurve:Fa,CatmullRomCurve3:Ba,CubicBezierCurve:zr,CubicBezierCurve3:ka,EllipseCurve:Hs,LineCurve:Gr,LineCurve3:za,QuadraticBezierCurve:Vr,QuadraticBezierCurve3:Ga,SplineCurve:Hr}),Va=class extends vn{constructor(){super(),this.type="CurvePath",this.curves=[],this.autoClose=!1,this.cacheLengths=null}add(t){this.curves.push(t)}closePath(){let t=this.curves[0].getPoint(0),e=this.curves[this.curves.length-1].getPoint(1);if(!t.equals(e)){let n=t.isVector2===!0?"LineCurve":"LineCurve3";this.curves.push(new Sh[n](e,t))}return this}getPoint(t,e){let n=t*this.getLength(),s=this.getCurveLengths(),r=0;for(;r<s.length;){if(s[r]>=n){let o=s[r]-n,a=this.curves[r],l=a.getLength(),c=l===0?0:1-o/l;return a.getPointAt(c,e)}r++}return null}getLength(){let t=this.getCurveLengths();return t[t.length-1]}updateArcLengths(){this.needsUpdate=!0,this.cacheLengths=null,this.getCurveLengths()}getCurveLengths(){if(this.cacheLengths&&this.cacheLengths.length===this.curves.length)return this.cacheLengths;let t=[],e=0;for(let n=0,s=this.curves.length;n<s;n++)e+=this.curves[n].getLength(),t.push(e);return this.cacheLengths=t,t}getSpacedPoints(t=40){let e=[];for(let n=0;n<=t;n++)e.push(this.getPoint(n/t));return this.autoClose&&e.push(e[0]),e}getPoints(t=12){let e=[],n;for(let s=0,r=this.curves;s<r.length;s++){let o=r[s],a=o.isEllipseCurve?t*2:o.isLineCurve||o.isLineCurve3?1:o.isSplineCurve?t*o.points.length:t,l=o.getPoints(a);for(let c=0;c<l.length;c++){let h=l[c];n&&n.equals(h)||(e.push(h),n=h)}}return this.autoClose&&e.length>1&&!e[e.length-1].equals(e[0])&&e.push(e[0]),e}copy(t){super.copy(t),this.curves=[];for(let e=0,n=t.curves.length;e<n;e++){let s=t.curves[e];this.curves.push(s.clone())}return this.autoClose=t.autoClose,this.cacheLengths=null,this}toJSON(){let t=super.toJSON();t.autoClose=this.autoClose,t.curves=[];for(let e=0,n=this.curves.length;e<n;e++){let s=this.curves[e];t.curves.push(s.toJSON())}return t}fromJSON(t){super.fromJSON(t),this.autoClose=t.autoClose,this.curves=[];for(let e=0,n=t.curves.length;e<n;e++){let s=t.curves[e];this.curves.push(new Sh[s.type]().fromJSON(s))}return this.cacheLengths=null,this}},Wr=class extends Va{constructor(t){super(),this.type="Path",this.currentPoint=new rt,t&&this.setFromPoints(t)}setFromPoints(t){this.moveTo(t[0].x,t[0].y);for(let e=1,n=t.length;e<n;e++)this.lineTo(t[e].x,t[e].y);return this}moveTo(t,e){return this.currentPoint.set(t,e),this}lineTo(t,e){let n=new Gr(this.currentPoint.clone(),new rt(t,e));return this.curves.push(n),this.currentPoint.set(t,e),this}quadraticCurveTo(t,e,n,s){let r=new Vr(this.currentPoint.clone(),new rt(t,e),new rt(n,s));return this.curves.push(r),this.currentPoint.set(n,s),this}bezierCurveTo(t,e,n,s,r,o){let a=new zr(this.currentPoint.clone(),new rt(t,e),new rt(n,s),new rt(r,o));return this.curves.push(a),this.currentPoint.set(r,o),this}splineThru(t){let e=[this.currentPoint.clone()].concat(t),n=new Hr(e);return this.curves.push(n),this.currentPoint.copy(t[t.length-1]),this}arc(t,e,n,s,r,o){let a=this.currentPoint.x,l=this.currentPoint.y;return this.absarc(t+a,e+l,n,s,r,o),this}absarc(t,e,n,s,r,o){return this.absellipse(t,e,n,n,s,r,o),this}ellipse(t,e,n,s,r,o,a,l){let c=this.currentPoint.x,h=this.currentPoint.y;return this.absellipse(t+c,e+h,n,s,r,o,a,l),this}absellipse(t,e,n,s,r,o,a,l){let c=new Hs(t,e,n,s,r,o,a,l);if(this.curves.length>0){let u=c.getPoint(0);u.equals(this.currentPoint)||this.lineTo(u.x,u.y)}this.curves.push(c);let h=c.getPoint(1);return this.currentPoint.copy(h),this}copy(t){return super.copy(t),this.currentPoint.copy(t.currentPoint),this}toJSON(){let t=super.toJSON();return t.currentPoint=this.currentPoint.toArray(),t}fromJSON(t){return super.fromJSON(t),this.currentPoint.fromArray(t.currentPoint),this}},Fi=class extends Wr{constructor(t){super(t),this.uuid=us(),this.type="Shape",this.holes=[]}getPointsHoles(t){let e=[];for(let n=0,s=this.holes.length;n<s;n++)e[n]=this.holes[n].getPoints(t);return e}extractPoints(t){return{shape:this.getPoints(t),holes:this.getPointsHoles(t)}}copy(t){super.copy(t),this.holes=[];for(let e=0,n=t.holes.length;e<n;e++){let s=t.holes[e];this.holes.push(s.clone())}return this}toJSON(){let t=super.toJSON();t.uuid=this.uuid,t.holes=[];for(let e=0,n=this.holes.length;e<n;e++){let s=this.holes[e];t.holes.push(s.toJSON())}return t}fromJSON(t){super.fromJSON(t),this.uuid=t.uuid,this.holes=[];for(let e=0,n=t.holes.length;e<n;e++){let s=t.holes[e];this.holes.push(new Wr().fromJSON(s))}return this}};function i_(i,t,e=2){let n=t&&t.length,s=n?t[0]*e:i.length,r=pp(i,0,s,e,!0),o=[];if(!r||r.next===r.prev)return o;let a,l,c;if(n&&(r=l_(i,t,r,e)),i.length>80*e){a=i[0],l=i[1];let h=a,u=l;for(let d=e;d<s;d+=e){let f=i[d],m=i[d+1];f<a&&(a=f),m<l&&(l=m),f>h&&(h=f),m>u&&(u=m)}c=Math.max(h-a,u-l),c=c!==0?32767/c:0}return Xr(r,o,e,a,l,c,0),o}function pp(i,t,e,n,s){let r;if(s===v_(i,t,e,n)>0)for(let o=t;o<e;o+=n)r=Mf(o/n|0,i[o],i[o+1],r);else for(let o=e-n;o>=t;o-=n)r=Mf(o/n|0,i[o],i[o+1],r);return r&&Ws(r,r.next)&&($r(r),r=r.next),r}function os(i,t){if(!i)return i;t||(t=i);let e=i,n;do if(n=!1,!e.steiner&&(Ws(e,e.next)||Pe(e.prev,e,e.next)===0)){if($r(e),e=t=e.prev,e===e.next)break;n=!0}else e=e.next;while(n||e!==t);return t}function Xr(i,t,e,n,s,r,o){if(!i)return;!o&&r&&f_(i,n,s,r);let a=i;for(;i.prev!==i.next;){let l=i.prev,c=i.next;if(r?r_(i,n,s,r):s_(i)){t.push(l.i,i.i,c.i),$r(i),i=c.next,a=c.next;continue}if(i=c,i===a){o?o===1?(i=o_(os(i),t),Xr(i,t,e,n,s,r,2)):o===2&&a_(i,t,e,n,s,r):Xr(os(i),t,e,n,s,r,1);break}}}function s_(i){let t=i.prev,e=i,n=i.next;if(Pe(t,e,n)>=0)return!1;let s=t.x,r=e.x,o=n.x,a=t.y,l=e.y,c=n.y,h=Math.min(s,r,o),u=Math.min(a,l,c),d=Math.max(s,r,o),f=Math.max(a,l,c),m=n.next;for(;m!==t;){if(m.x>=h&&m.x<=d&&m.y>=u&&m.y<=f&&Mr(s,a,r,l,o,c,m.x,m.y)&&Pe(m.prev,m,m.next)>=0)return!1;m=m.next}return!0}function r_(i,t,e,n){let s=i.prev,r=i,o=i.next;if(Pe(s,r,o)>=0)return!1;let a=s.x,l=r.x,c=o.x,h=s.y,u=r.y,d=o.y,f=Math.min(a,l,c),m=Math.min(h,u,d),x=Math.max(a,l,c),p=Math.max(h,u,d),g=wh(f,m,t,e,n),y=wh(x,p,t,e,n),w=i.prevZ,S=i.nextZ;for(;w&&w.z>=g&&S&&S.z<=y;){if(w.x>=f&&w.x<=x&&w.y>=m&&w.y<=p&&w!==s&&w!==o&&Mr(a,h,l,u,c,d,w.x,w.y)&&Pe(w.prev,w,w.next)>=0||(w=w.prevZ,S.x>=f&&S.x<=x&&S.y>=m&&S.y<=p&&S!==s&&S!==o&&Mr(a,h,l,u,c,d,S.x,S.y)&&Pe(S.prev,S,S.next)>=0))return!1;S=S.nextZ}for(;w&&w.z>=g;){if(w.x>=f&&w.x<=x&&w.y>=m&&w.y<=p&&w!==s&&w!==o&&Mr(a,h,l,u,c,d,w.x,w.y)&&Pe(w.prev,w,w.next)>=0)return!1;w=w.prevZ}for(;S&&S.z<=y;){if(S.x>=f&&S.x<=x&&S.y>=m&&S.y<=p&&S!==s&&S!==o&&Mr(a,h,l,u,c,d,S.x,S.y)&&Pe(S.prev,S,S.next)>=0)return!1;S=S.nextZ}return!0}function o_(i,t){let e=i;do{let n=e.prev,s=e.next.next;!Ws(n,s)&&gp(n,e,e.next,s)&&qr(n,s)&&qr(s,n)&&(t.push(n.i,e.i,s.i),$r(e),$r(e.next),e=i=s),e=e.next}while(e!==i);return os(e)}function a_(i,t,e,n,s,r){let o=i;do{let a=o.next.next;for(;a!==o.prev;){if(o.i!==a.i&&g_(o,a)){let l=_p(o,a);o=os(o,o.next),l=os(l,l.next),Xr(o,t,e,n,s,r,0),Xr(l,t,e,n,s,r,0);return}a=a.next}o=o.next}while(o!==i)}function l_(i,t,e,n){let s=[];for(let r=0,o=t.length;r<o;r++){let a=t[r]*n,l=r<o-1?t[r+1]*n:i.length,c=pp(i,a,l,n,!1);c===c.next&&(c.steiner=!0),s.push(m_(c))}s.sort(c_);for(let r=0;r<s.length;r++)e=h_(s[r],e);return e}function c_(i,t){let e=i.x-t.x;if(e===0&&(e=i.y-t.y,e===0)){let n=(i.next.y-i.y)/(i.next.x-i.x),s=(t.next.y-t.y)/(t.next.x-t.x);e=n-s}return e}function h_(i,t){let e=u_(i,t);if(!e)return t;let n=_p(e,i);return os(n,n.next),os(e,e.next)}function u_(i,t){let e=t,n=i.x,s=i.y,r=-1/0,o;if(Ws(i,e))return e;do{if(Ws(i,e.next))return e.next;if(s<=e.y&&s>=e.next.y&&e.next.y!==e.y){let u=e.x+(s-e.y)*(e.next.x-e.x)/(e.next.y-e.y);if(u<=n&&u>r&&(r=u,o=e.x<e.next.x?e:e.next,u===n))return o}e=e.next}while(e!==t);if(!o)return null;let a=o,l=o.x,c=o.y,h=1/0;e=o;do{if(n>=e.x&&e.x>=l&&n!==e.x&&mp(s<c?n:r,s,l,c,s<c?r:n,s,e.x,e.y)){let u=Math.abs(s-e.y)/(n-e.x);qr(e,i)&&(u<h||u===h&&(e.x>o.x||e.x===o.x&&d_(o,e)))&&(o=e,h=u)}e=e.next}while(e!==a);return o}function d_(i,t){return Pe(i.prev,i,t.prev)<0&&Pe(t.next,i,i.next)<0}function f_(i,t,e,n){let s=i;do s.z===0&&(s.z=wh(s.x,s.y,t,e,n)),s.prevZ=s.prev,s.nextZ=s.next,s=s.next;while(s!==i);s.prevZ.nextZ=null,s.prevZ=null,p_(s)}function p_(i){let t,e=1;do{let n=i,s;i=null;let r=null;for(t=0;n;){t++;let o=n,a=0;for(let c=0;c<e&&(a++,o=o.nextZ,!!o);c++);let l=e;for(;a>0||l>0&&o;)a!==0&&(l===0||!o||n.z<=o.z)?(s=n,n=n.nextZ,a--):(s=o,o=o.nextZ,l--),r?r.nextZ=s:i=s,s.prevZ=r,r=s;n=o}r.nextZ=null,e*=2}while(t>1);return i}function wh(i,t,e,n,s){return i=(i-e)*s|0,t=(t-n)*s|0,i=(i|i<<8)&16711935,i=(i|i<<4)&252645135,i=(i|i<<2)&858993459,i=(i|i<<1)&1431655765,t=(t|t<<8)&16711935,t=(t|t<<4)&252645135,t=(t|t<<2)&858993459,t=(t|t<<1)&1431655765,i|t<<1}function m_(i){let t=i,e=i;do(t.x<e.x||t.x===e.x&&t.y<e.y)&&(e=t),t=t.next;while(t!==i);return e}function mp(i,t,e,n,s,r,o,a){return(s-o)*(t-a)>=(i-o)*(r-a)&&(i-o)*(n-a)>=(e-o)*(t-a)&&(e-o)*(r-a)>=(s-o)*(n-a)}function Mr(i,t,e,n,s,r,o,a){return!(i===o&&t===a)&&mp(i,t,e,n,s,r,o,a)}function g_(i,t){return i.next.i!==t.i&&i.prev.i!==t.i&&!__(i,t)&&(qr(i,t)&&qr(t,i)&&x_(i,t)&&(Pe(i.prev,i,t.prev)||Pe(i,t.prev,t))||Ws(i,t)&&Pe(i.prev,i,i.next)>0&&Pe(t.prev,t,t.next)>0)}function Pe(i,t,e){return(t.y-i.y)*(e.x-t.x)-(t.x-i.x)*(e.y-t.y)}function Ws(i,t){return i.x===t.x&&i.y===t.y}function gp(i,t,e,n){let s=pa(Pe(i,t,e)),r=pa(Pe(i,t,n)),o=pa(Pe(e,n,i)),a=pa(Pe(e,n,t));return!!(s!==r&&o!==a||s===0&&fa(i,e,t)||r===0&&fa(i,n,t)||o===0&&fa(e,i,n)||a===0&&fa(e,t,n))}function fa(i,t,e){return t.x<=Math.max(i.x,e.x)&&t.x>=Math.min(i.x,e.x)&&t.y<=Math.max(i.y,e.y)&&t.y>=Math.min(i.y,e.y)}function pa(i){return i>0?1:i<0?-1:0}function __(i,t){let e=i;do{if(e.i!==i.i&&e.next.i!==i.i&&e.i!==t.i&&e.next.i!==t.i&&gp(e,e.next,i,t))return!0;e=e.next}while(e!==i);return!1}function qr(i,t){return Pe(i.prev,i,i.next)<0?Pe(i,t,i.next)>=0&&Pe(i,i.prev,t)>=0:Pe(i,t,i.prev)<0||Pe(i,i.next,t)<0}function x_(i,t){let e=i,n=!1,s=(i.x+t.x)/2,r=(i.y+t.y)/2;do e.y>r!=e.next.y>r&&e.next.y!==e.y&&s<(e.next.x-e.x)*(r-e.y)/(e.next.y-e.y)+e.x&&(n=!n),e=e.next;while(e!==i);return n}function _p(i,t){let e=Eh(i.i,i.x,i.y),n=Eh(t.i,t.x,t.y),s=i.next,r=t.prev;return i.next=t,t.prev=i,e.next=s,s.prev=e,n.next=e,e.prev=n,r.next=n,n.prev=r,n}function Mf(i,t,e,n){let s=Eh(i,t,e);return n?(s.next=n.next,s.prev=n,n.next.prev=s,n.next=s):(s.prev=s,s.next=s),s}function $r(i){i.next.prev=i.prev,i.prev.next=i.next,i.prevZ&&(i.prevZ.nextZ=i.nextZ),i.nextZ&&(i.nextZ.prevZ=i.prevZ)}function Eh(i,t,e){return{i,x:t,y:e,prev:null,next:null,z:0,prevZ:null,nextZ:null,steiner:!1}}function v_(i,t,e,n){let s=0;for(let r=t,o=e-n;r<e;r+=n)s+=(i[o]-i[r])*(i[r+1]+i[o+1]),o=r;return s}var Ah=class{static triangulate(t,e,n=2){return i_(t,e,n)}},Zn=class i{static area(t){let e=t.length,n=0;for(let s=e-1,r=0;r<e;s=r++)n+=t[s].x*t[r].y-t[r].x*t[s].y;return n*.5}static isClockWise(t){return i.area(t)<0}static triangulateShape(t,e){let n=[],s=[],r=[];Sf(t),wf(n,t);let o=t.length;e.forEach(Sf);for(let l=0;l<e.length;l++)s.push(o),o+=e[l].length,wf(n,e[l]);let a=Ah.triangulate(n,s);for(let l=0;l<a.length;l+=3)r.push(a.slice(l,l+3));return r}};function Sf(i){let t=i.length;t>2&&i[t-1].equals(i[0])&&i.pop()}function wf(i,t){for(let e=0;e<t.length;e++)i.push(t[e].x),i.push(t[e].y)}var Yr=class i extends Se{constructor(t=new Fi([new rt(.5,.5),new rt(-.5,.5),new rt(-.5,-.5),new rt(.5,-.5)]),e={}){super(),this.type="ExtrudeGeometry",this.parameters={shapes:t,options:e},t=Array.isArray(t)?t:[t];let n=this,s=[],r=[];for(let a=0,l=t.length;a<l;a++){let c=t[a];o(c)}this.setAttribute("position",new ze(s,3)),this.setAttribute("uv",new ze(r,2)),this.computeVertexNormals();function o(a){let l=[],c=e.curveSegments!==void 0?e.curveSegments:12,h=e.steps!==void 0?e.steps:1,u=e.depth!==void 0?e.depth:1,d=e.bevelEnabled!==void 0?e.bevelEnabled:!0,f=e.bevelThickness!==void 0?e.bevelThickness:.2,m=e.bevelSize!==void 0?e.bevelSize:f-.1,x=e.bevelOffset!==void 0?e.bevelOffset:0,p=e.bevelSegments!==void 0?e.bevelSegments:3,g=e.extrudePath,y=e.UVGenerator!==void 0?e.UVGenerator:y_,w,S=!1,T,A,_,E;if(g){w=g.getSpacedPoints(h),S=!0,d=!1;let tt=g.isCatmullRomCurve3?g.closed:!1;T=g.computeFrenetFrames(h,tt),A=new I,_=new I,E=new I}d||(p=0,f=0,m=0,x=0);let O=a.extractPoints(c),P=O.shape,U=O.holes;if(!Zn.isClockWise(P)){P=P.reverse();for(let tt=0,ut=U.length;tt<ut;tt++){let at=U[tt];Zn.isClockWise(at)&&(U[tt]=at.reverse())}}function $(tt){let at=10000000000000001e-36,Tt=tt[0];for(let yt=1;yt<=tt.length;yt++){let Jt=yt%tt.length,Ut=tt[Jt],re=Ut.x-Tt.x,oe=Ut.y-Tt.y,de=re*re+oe*oe,N=Math.max(Math.abs(Ut.x),Math.abs(Ut.y),Math.abs(Tt.x),Math.abs(Tt.y)),Oe=at*N*N;if(de<=Oe){tt.splice(Jt,1),yt--;continue}Tt=Ut}}$(P),U.forEach($);let L=U.length,V=P;for(let tt=0;tt<L;tt++){let ut=U[tt];P=P.concat(ut)}function X(tt,ut,at){return ut||Wt("ExtrudeGeometry: vec does not exist"),tt.clone().addScaledVector(ut,at)}let z=P.length;function nt(tt,ut,at){let Tt,yt,Jt,Ut=tt.x-ut.x,re=tt.y-ut.y,oe=at.x-tt.x,de=at.y-tt.y,N=Ut*Ut+re*re,Oe=Ut*de-re*oe;if(Math.abs(Oe)>Number.EPSILON){let ie=Math.sqrt(N),be=Math.sqrt(oe*oe+de*de),gt=ut.x-re/ie,Le=ut.y+Ut/ie,Gt=at.x-de/be,qt=at.y+oe/be,C=((Gt-gt)*de-(qt-Le)*oe)/(Ut*de-re*oe);Tt=gt+Ut*C-tt.x,yt=Le+re*C-tt.y;let v=Tt*Tt+yt*yt;if(v<=2)return new rt(Tt,yt);Jt=Math.sqrt(v/2)}else{let ie=!1;Ut>Number.EPSILON?oe>Number.EPSILON&&(ie=!0):Ut<-Number.EPSILON?oe<-Number.EPSILON&&(ie=!0):Math.sign(re)===Math.sign(de)&&(ie=!0),ie?(Tt=-re,yt=Ut,Jt=Math.sqrt(N)):(Tt=Ut,yt=re,Jt=Math.sqrt(N/2))}return new rt(Tt/Jt,yt/Jt)}let H=[];for(let tt=0,ut=V.length,at=ut-1,Tt=tt+1;tt<ut;tt++,at++,Tt++)at===ut&&(at=0),Tt===ut&&(Tt=0),H[tt]=nt(V[tt],V[at],V[Tt]);let Q=[],et,Et=H.concat();for(let tt=0,ut=L;tt<ut;tt++){let at=U[tt];et=[];for(let Tt=0,yt=at.length,Jt=yt-1,Ut=Tt+1;Tt<yt;Tt++,Jt++,Ut++)Jt===yt&&(Jt=0),Ut===yt&&(Ut=0),et[Tt]=nt(at[Tt],at[Jt],at[Ut]);Q.push(et),Et=Et.concat(et)}let Nt;if(p===0)Nt=Zn.triangulateShape(V,U);else{let tt=[],ut=[];for(let at=0;at<p;at++){let Tt=at/p,yt=f*Math.cos(Tt*Math.PI/2),Jt=m*Math.sin(Tt*Math.PI/2)+x;for(let Ut=0,re=V.length;Ut<re;Ut++){let oe=X(V[Ut],H[Ut],Jt);Bt(oe.x,oe.y,-yt),Tt===0&&tt.push(oe)}for(let Ut=0,re=L;Ut<re;Ut++){let oe=U[Ut];et=Q[Ut];let de=[];for(let N=0,Oe=oe.length;N<Oe;N++){let ie=X(oe[N],et[N],Jt);Bt(ie.x,ie.y,-yt),Tt===0&&de.push(ie)}Tt===0&&ut.push(de)}}Nt=Zn.triangulateShape(tt,ut)}let Y=Nt.length,ht=m+x;for(let tt=0;tt<z;tt++){let ut=d?X(P[tt],Et[tt],ht):P[tt];S?(_.copy(T.normals[0]).multiplyScalar(ut.x),A.copy(T.binormals[0]).multiplyScalar(ut.y),E.copy(w[0]).add(_).add(A),Bt(E.x,E.y,E.z)):Bt(ut.x,ut.y,0)}for(let tt=1;tt<=h;tt++)for(let ut=0;ut<z;ut++){let at=d?X(P[ut],Et[ut],ht):P[ut];S?(_.copy(T.normals[tt]).multiplyScalar(at.x),A.copy(T.binormals[tt]).multiplyScalar(at.y),E.copy(w[tt]).add(_).add(A),Bt(E.x,E.y,E.z)):Bt(at.x,at.y,u/h*tt)}for(let tt=p-1;tt>=0;tt--){let ut=tt/p,at=f*Math.cos(ut*Math.PI/2),Tt=m*Math.sin(ut*Math.PI/2)+x;for(let yt=0,Jt=V.length;yt<Jt;yt++){let Ut=X(V[yt],H[yt],Tt);Bt(Ut.x,Ut.y,u+at)}for(let yt=0,Jt=U.length;yt<Jt;yt++){let Ut=U[yt];et=Q[yt];for(let re=0,oe=Ut.length;re<oe;re++){let de=X(Ut[re],et[re],Tt);S?Bt(de.x,de.y+w[h-1].y,w[h-1].x+at):Bt(de.x,de.y,u+at)}}}At(),Ot();function At(){let tt=s.length/3;if(d){let ut=0,at=z*ut;for(let Tt=0;Tt<Y;Tt++){let yt=Nt[Tt];ye(yt[2]+at,yt[1]+at,yt[0]+at)}ut=h+p*2,at=z*ut;for(let Tt=0;Tt<Y;Tt++){let yt=Nt[Tt];ye(yt[0]+at,yt[1]+at,yt[2]+at)}}else{for(let ut=0;ut<Y;ut++){let at=Nt[ut];ye(at[2],at[1],at[0])}for(let ut=0;ut<Y;ut++){let at=Nt[ut];ye(at[0]+z*h,at[1]+z*h,at[2]+z*h)}}n.addGroup(tt,s.length/3-tt,0)}function Ot(){let tt=s.length/3,ut=0;vt(V,ut),ut+=V.length;for(let at=0,Tt=U.length;at<Tt;at++){let yt=U[at];vt(yt,ut),ut+=yt.length}n.addGroup(tt,s.length/3-tt,1)}function vt(tt,ut){let at=tt.length;for(;--at>=0;){let Tt=at,yt=at-1;yt<0&&(yt=tt.length-1);for(let Jt=0,Ut=h+p*2;Jt<Ut;Jt++){let re=z*Jt,oe=z*(Jt+1),de=ut+Tt+re,N=ut+yt+re,Oe=ut+yt+oe,ie=ut+Tt+oe;kt(de,N,Oe,ie)}}}function Bt(tt,ut,at){l.push(tt),l.push(ut),l.push(at)}function ye(tt,ut,at){jt(tt),jt(ut),jt(at);let Tt=s.length/3,yt=y.generateTopUV(n,s,Tt-3,Tt-2,Tt-1);Qt(yt[0]),Qt(yt[1]),Qt(yt[2])}function kt(tt,ut,at,Tt){jt(tt),jt(ut),jt(Tt),jt(ut),jt(at),jt(Tt);let yt=s.length/3,Jt=y.generateSideWallUV(n,s,yt-6,yt-3,yt-2,yt-1);Qt(Jt[0]),Qt(Jt[1]),Qt(Jt[3]),Qt(Jt[1]),Qt(Jt[2]),Qt(Jt[3])}function jt(tt){s.push(l[tt*3+0]),s.push(l[tt*3+1]),s.push(l[tt*3+2])}function Qt(tt){r.push(tt.x),r.push(tt.y)}}}copy(t){return super.copy(t),this.parameters=Object.assign({},t.parameters),this}toJSON(){let t=super.toJSON(),e=this.parameters.shapes,n=this.parameters.options;return b_(e,n,t)}static fromJSON(t,e){let n=[];for(let r=0,o=t.shapes.length;r<o;r++){let a=e[t.shapes[r]];n.push(a)}let s=t.options.extrudePath;return s!==void 0&&(t.options.extrudePath=new Sh[s.type]().fromJSON(s)),new i(n,t.options)}},y_={generateTopUV:function(i,t,e,n,s){let r=t[e*3],o=t[e*3+1],a=t[n*3],l=t[n*3+1],c=t[s*3],h=t[s*3+1];return[new rt(r,o),new rt(a,l),new rt(c,h)]},generateSideWallUV:function(i,t,e,n,s,r){let o=t[e*3],a=t[e*3+1],l=t[e*3+2],c=t[n*3],h=t[n*3+1],u=t[n*3+2],d=t[s*3],f=t[s*3+1],m=t[s*3+2],x=t[r*3],p=t[r*3+1],g=t[r*3+2];return Math.abs(a-h)<Math.abs(o-c)?[new rt(o,1-l),new rt(c,1-u),new rt(d,1-m),new rt(x,1-g)]:[new rt(a,1-l),new rt(h,1-u),new rt(f,1-m),new rt(p,1-g)]}};function b_(i,t,e){if(e.shapes=[],Array.isArray(i))for(let n=0,s=i.length;n<s;n++){let r=i[n];e.shapes.push(r.uuid)}else e.shapes.push(i.uuid);return e.options=Object.assign({},t),t.extrudePath!==void 0&&(e.options.extrudePath=t.extrudePath.toJSON()),e}var Bi=class i extends Se{constructor(t=1,e=1,n=1,s=1){super(),this.type="PlaneGeometry",this.parameters={width:t,height:e,widthSegments:n,heightSegments:s};let r=t/2,o=e/2,a=Math.floor(n),l=Math.floor(s),c=a+1,h=l+1,u=t/a,d=e/l,f=[],m=[],x=[],p=[];for(let g=0;g<h;g++){let y=g*d-o;for(let w=0;w<c;w++){let S=w*u-r;m.push(S,-y,0),x.push(0,0,1),p.push(w/a),p.push(1-g/l)}}for(let g=0;g<l;g++)for(let y=0;y<a;y++){let w=y+c*g,S=y+c*(g+1),T=y+1+c*(g+1),A=y+1+c*g;f.push(w,S,A),f.push(S,T,A)}this.setIndex(f),this.setAttribute("position",new ze(m,3)),this.setAttribute("normal",new ze(x,3)),this.setAttribute("uv",new ze(p,2))}copy(t){return super.copy(t),this.parameters=Object.assign({},t.parameters),this}static fromJSON(t){return new i(t.width,t.height,t.widthSegments,t.heightSegments)}};var Zr=class i extends Se{constructor(t=new Fi([new rt(0,.5),new rt(-.5,-.5),new rt(.5,-.5)]),e=12){super(),this.type="ShapeGeometry",this.parameters={shapes:t,curveSegments:e};let n=[],s=[],r=[],o=[],a=0,l=0;if(Array.isArray(t)===!1)c(t);else for(let h=0;h<t.length;h++)c(t[h]),this.addGroup(a,l,h),a+=l,l=0;this.setIndex(n),this.setAttribute("position",new ze(s,3)),this.setAttribute("normal",new ze(r,3)),this.setAttribute("uv",new ze(o,2));function c(h){let u=s.length/3,d=h.extractPoints(e),f=d.shape,m=d.holes;Zn.isClockWise(f)===!1&&(f=f.reverse());for(let p=0,g=m.length;p<g;p++){let y=m[p];Zn.isClockWise(y)===!0&&(m[p]=y.reverse())}let x=Zn.triangulateShape(f,m);for(let p=0,g=m.length;p<g;p++){let y=m[p];f=f.concat(y)}for(let p=0,g=f.length;p<g;p++){let y=f[p];s.push(y.x,y.y,0),r.push(0,0,1),o.push(y.x,y.y)}for(let p=0,g=x.length;p<g;p++){let y=x[p],w=y[0]+u,S=y[1]+u,T=y[2]+u;n.push(w,S,T),l+=3}}}copy(t){return super.copy(t),this.parameters=Object.assign({},t.parameters),this}toJSON(){let t=super.toJSON(),e=this.parameters.shapes;return M_(e,t)}static fromJSON(t,e){let n=[];for(let s=0,r=t.shapes.length;s<r;s++){let o=e[t.shapes[s]];n.push(o)}return new i(n,t.curveSegments)}};function M_(i,t){if(t.shapes=[],Array.isArray(i))for(let e=0,n=i.length;e<n;e++){let s=i[e];t.shapes.push(s.uuid)}else t.shapes.push(i.uuid);return t}function ds(i){let t={};for(let e in i){t[e]={};for(let n in i[e]){let s=i[e][n];if(Ef(s))s.isRenderTargetTexture?(Vt("UniformsUtils: Textures of render targets cannot be cloned via cloneUniforms() or mergeUniforms()."),t[e][n]=null):t[e][n]=s.clone();else if(Array.isArray(s))if(Ef(s[0])){let r=[];for(let o=0,a=s.length;o<a;o++)r[o]=s[o].clone();t[e][n]=r}else t[e][n]=s.slice();else t[e][n]=s}}return t}function on(i){let t={};for(let e=0;e<i.length;e++){let n=ds(i[e]);for(let s in n)t[s]=n[s]}return t}function Ef(i){return i&&(i.isColor||i.isMatrix3||i.isMatrix4||i.isVector2||i.isVector3||i.isVector4||i.isTexture||i.isQuaternion)}function S_(i){let t=[];for(let e=0;e<i.length;e++)t.push(i[e].clone());return t}function hu(i){let t=i.getRenderTarget();return t===null?i.outputColorSpace:t.isXRRenderTarget===!0?t.texture.colorSpace:se.workingColorSpace}var xp={clone:ds,merge:on},w_=`void main() {
	gl_Position = projectionMatrix * modelViewMatrix * vec4( position, 1.0 );
}`,E_=`void main() {
	gl_FragColor = vec4( 1.0, 0.0, 0.0, 1.0 );
}`,Je=class extends _i{constructor(t){super(),this.isShaderMaterial=!0,this.type="ShaderMaterial",this.defines={},this.uniforms={},this.uniformsGroups=[],this.vertexShader=w_,this.fragmentShader=E_,this.linewidth=1,this.wireframe=!1,this.wireframeLinewidth=1,this.fog=!1,this.lights=!1,this.clipping=!1,this.forceSinglePass=!0,this.extensions={clipCullDistance:!1,multiDraw:!1},this.defaultAttributeValues={color:[1,1,1],uv:[0,0],uv1:[0,0]},this.index0AttributeName=void 0,this.uniformsNeedUpdate=!1,this.glslVersion=null,t!==void 0&&this.setValues(t)}copy(t){return super.copy(t),this.fragmentShader=t.fragmentShader,this.vertexShader=t.vertexShader,this.uniforms=ds(t.uniforms),this.uniformsGroups=S_(t.uniformsGroups),this.defines=Object.assign({},t.defines),this.wireframe=t.wireframe,this.wireframeLinewidth=t.wireframeLinewidth,this.fog=t.fog,this.lights=t.lights,this.clipping=t.clipping,this.extensions=Object.assign({},t.extensions),this.glslVersion=t.glslVersion,this.defaultAttributeValues=Object.assign({},t.defaultAttributeValues),this.index0AttributeName=t.index0AttributeName,this.uniformsNeedUpdate=t.uniformsNeedUpdate,this}toJSON(t){let e=super.toJSON(t);e.glslVersion=this.glslVersion,e.uniforms={};for(let s in this.uniforms){let o=this.uniforms[s].value;o&&o.isTexture?e.uniforms[s]={type:"t",value:o.toJSON(t).uuid}:o&&o.isColor?e.uniforms[s]={type:"c",value:o.getHex()}:o&&o.isVector2?e.uniforms[s]={type:"v2",value:o.toArray()}:o&&o.isVector3?e.uniforms[s]={type:"v3",value:o.toArray()}:o&&o.isVector4?e.uniforms[s]={type:"v4",value:o.toArray()}:o&&o.isMatrix3?e.uniforms[s]={type:"m3",value:o.toArray()}:o&&o.isMatrix4?e.uniforms[s]={type:"m4",value:o.toArray()}:e.uniforms[s]={value:o}}Object.keys(this.defines).length>0&&(e.defines=this.defines),e.vertexShader=this.vertexShader,e.fragmentShader=this.fragmentShader,e.lights=this.lights,e.clipping=this.clipping;let n={};for(let s in this.extensions)this.extensions[s]===!0&&(n[s]=!0);return Object.keys(n).length>0&&(e.extensions=n),e}fromJSON(t,e){if(super.fromJSON(t,e),t.uniforms!==void 0)for(let n in t.uniforms){let s=t.uniforms[n];switch(this.uniforms[n]={},s.type){case"t":this.uniforms[n].value=e[s.value]||null;break;case"c":this.uniforms[n].value=new Yt().setHex(s.value);break;case"v2":this.uniforms[n].value=new rt().fromArray(s.value);break;case"v3":this.uniforms[n].value=new I().fromArray(s.value);break;case"v4":this.uniforms[n].value=new Te().fromArray(s.value);break;case"m3":this.uniforms[n].value=new $t().fromArray(s.value);break;case"m4":this.uniforms[n].value=new ue().fromArray(s.value);break;default:this.uniforms[n].value=s.value}}if(t.defines!==void 0&&(this.defines=t.defines),t.vertexShader!==void 0&&(this.vertexShader=t.vertexShader),t.fragmentShader!==void 0&&(this.fragmentShader=t.fragmentShader),t.glslVersion!==void 0&&(this.glslVersion=t.glslVersion),t.extensions!==void 0)for(let n in t.extensions)this.extensions[n]=t.extensions[n];return t.lights!==void 0&&(this.lights=t.lights),t.clipping!==void 0&&(this.clipping=t.clipping),this}},Ha=class extends Je{constructor(t){super(t),this.isRawShaderMaterial=!0,this.type="RawShaderMaterial"}};var Wa=class extends _i{constructor(t){super(),this.isMeshDepthMaterial=!0,this.type="MeshDepthMaterial",this.depthPacking=Qf,this.map=null,this.alphaMap=null,this.displacementMap=null,this.displacementScale=1,this.displacementBias=0,this.wireframe=!1,this.wireframeLinewidth=1,this.setValues(t)}copy(t){return super.copy(t),this.depthPacking=t.depthPacking,this.map=t.map,this.alphaMap=t.alphaMap,this.displacementMap=t.displacementMap,this.displacementScale=t.displacementScale,this.displacementBias=t.displacementBias,this.wireframe=t.wireframe,this.wireframeLinewidth=t.wireframeLinewidth,this}},Xa=class extends _i{constructor(t){super(),this.isMeshDistanceMaterial=!0,this.type="MeshDistanceMaterial",this.map=null,this.alphaMap=null,this.displacementMap=null,this.displacementScale=1,this.displacementBias=0,this.setValues(t)}copy(t){return super.copy(t),this.map=t.map,this.alphaMap=t.alphaMap,this.displacementMap=t.displacementMap,this.displacementScale=t.displacementScale,this.displacementBias=t.displacementBias,this}};function Rs(i,t){return!i||i.constructor===t?i:typeof t.BYTES_PER_ELEMENT=="number"?new t(i):Array.prototype.slice.call(i)}function ma(i){return i!==void 0&&i.inTangents!==void 0&&i.outTangents!==void 0}var ki=class{constructor(t,e,n,s){this.parameterPositions=t,this._cachedIndex=0,this.resultBuffer=s!==void 0?s:new e.constructor(n),this.sampleValues=e,this.valueSize=n,this.settings=null,this.DefaultSettings_={}}evaluate(t){let e=this.parameterPositions,n=this._cachedIndex,s=e[n],r=e[n-1];n:{t:{let o;e:{i:if(!(t<s)){for(let a=n+2;;){if(s===void 0){if(t<r)break i;return n=e.length,this._cachedIndex=n,this.copySampleValue_(n-1)}if(n===a)break;if(r=s,s=e[++n],t<s)break t}o=e.length;break e}if(!(t>=r)){let a=e[1];t<a&&(n=2,r=a);for(let l=n-2;;){if(r===void 0)return this._cachedIndex=0,this.copySampleValue_(0);if(n===l)break;if(s=r,r=e[--n-1],t>=r)break t}o=n,n=0;break e}break n}for(;n<o;){let a=n+o>>>1;t<e[a]?o=a:n=a+1}if(s=e[n],r=e[n-1],r===void 0)return this._cachedIndex=0,this.copySampleValue_(0);if(s===void 0)return n=e.length,this._cachedIndex=n,this.copySampleValue_(n-1)}this._cachedIndex=n,this.intervalChanged_(n,r,s)}return this.interpolate_(n,r,t,s)}getSettings_(){return this.settings||this.DefaultSettings_}copySampleValue_(t){let e=this.resultBuffer,n=this.sampleValues,s=this.valueSize,r=t*s;for(let o=0;o!==s;++o)e[o]=n[r+o];return e}interpolate_(){throw new Error("THREE.Interpolant: Call to abstract method.")}intervalChanged_(){}},qa=class extends ki{constructor(t,e,n,s){super(t,e,n,s),this._weightPrev=-0,this._offsetPrev=-0,this._weightNext=-0,this._offsetNext=-0,this.DefaultSettings_={endingStart:vh,endingEnd:vh}}intervalChanged_(t,e,n){let s=this.parameterPositions,r=t-2,o=t+1,a=s[r],l=s[o];if(a===void 0)switch(this.getSettings_().endingStart){case yh:r=t,a=2*e-n;break;case bh:r=s.length-2,a=e+s[r]-s[r+1];break;default:r=t,a=n}if(l===void 0)switch(this.getSettings_().endingEnd){case yh:o=t,l=2*n-e;break;case bh:o=1,l=n+s[1]-s[0];break;default:o=t-1,l=e}let c=(n-e)*.5,h=this.valueSize;this._weightPrev=c/(e-a),this._weightNext=c/(l-n),this._offsetPrev=r*h,this._offsetNext=o*h}interpolate_(t,e,n,s){let r=this.resultBuffer,o=this.sampleValues,a=this.valueSize,l=t*a,c=l-a,h=this._offsetPrev,u=this._offsetNext,d=this._weightPrev,f=this._weightNext,m=(n-e)/(s-e),x=m*m,p=x*m,g=-d*p+2*d*x-d*m,y=(1+d)*p+(-1.5-2*d)*x+(-.5+d)*m+1,w=(-1-f)*p+(1.5+f)*x+.5*m,S=f*p-f*x;for(let T=0;T!==a;++T)r[T]=g*o[h+T]+y*o[c+T]+w*o[l+T]+S*o[u+T];return r}},$a=class extends ki{constructor(t,e,n,s){super(t,e,n,s)}interpolate_(t,e,n,s){let r=this.resultBuffer,o=this.sampleValues,a=this.valueSize,l=t*a,c=l-a,h=(n-e)/(s-e),u=1-h;for(let d=0;d!==a;++d)r[d]=o[c+d]*u+o[l+d]*h;return r}},Ya=class extends ki{constructor(t,e,n,s){super(t,e,n,s)}interpolate_(t){return this.copySampleValue_(t-1)}},Za=class extends ki{interpolate_(t,e,n,s){let r=this.resultBuffer,o=this.sampleValues,a=this.valueSize,l=t*a,c=l-a,h=this.inTangents,u=this.outTangents;if(!h||!u){let m=(n-e)/(s-e),x=1-m;for(let p=0;p!==a;++p)r[p]=o[c+p]*x+o[l+p]*m;return r}let d=a*2,f=t-1;for(let m=0;m!==a;++m){let x=o[c+m],p=o[l+m],g=f*d+m*2,y=u[g],w=u[g+1],S=t*d+m*2,T=h[S],A=h[S+1],_=T_(n,e,y,T,s);r[m]=vp(_,x,w,A,p)}return r}};function vp(i,t,e,n,s){let r=1-i;return r*r*r*t+3*r*r*i*e+3*r*i*i*n+i*i*i*s}function A_(i,t,e,n,s){let r=1-i;return 3*r*r*(e-t)+6*r*i*(n-e)+3*i*i*(s-n)}function T_(i,t,e,n,s){let r=(i-t)/(s-t);for(let o=0;o<8;o++){let a=vp(r,t,e,n,s)-i;if(Math.abs(a)<1e-10)break;let l=A_(r,t,e,n,s);if(Math.abs(l)<1e-10)break;r=Math.max(0,Math.min(1,r-a/l))}return r}var yn=class{constructor(t,e,n,s){if(t===void 0)throw new Error("THREE.KeyframeTrack: track name is undefined");if(e===void 0||e.length===0)throw new Error("THREE.KeyframeTrack: no keyframes in track named "+t);this.name=t,this.times=Rs(e,this.TimeBufferType),this.values=Rs(n,this.ValueBufferType),this.setInterpolation(s||this.DefaultInterpolation)}static toJSON(t){let e=t.constructor,n;if(e.toJSON!==this.toJSON)n=e.toJSON(t);else{n={name:t.name,times:Rs(t.times,Array),values:Rs(t.values,Array)};let s=t.getInterpolation();s!==t.DefaultInterpolation&&(n.interpolation=s),ma(t.settings)&&(n.settings={inTangents:Rs(t.settings.inTangents,Array),outTangents:Rs(t.settings.outTangents,Array)})}return n.type=t.ValueTypeName,n}InterpolantFactoryMethodDiscrete(t){return new Ya(this.times,this.values,this.getValueSize(),t)}InterpolantFactoryMethodLinear(t){return new $a(this.times,this.values,this.getValueSize(),t)}InterpolantFactoryMethodSmooth(t){return new qa(this.times,this.values,this.getValueSize(),t)}InterpolantFactoryMethodBezier(t){let e=new Za(this.times,this.values,this.getValueSize(),t);return this.settings&&(e.inTangents=this.settings.inTangents,e.outTangents=this.settings.outTangents),e}setInterpolation(t){let e;switch(t){case Tr:e=this.InterpolantFactoryMethodDiscrete;break;case Ca:e=this.InterpolantFactoryMethodLinear;break;case xa:e=this.InterpolantFactoryMethodSmooth;break;case xh:e=this.InterpolantFactoryMethodBezier;break}if(e===void 0){let n="unsupported interpolation for "+this.ValueTypeName+" keyframe track named "+this.name;if(this.createInterpolant===void 0)if(t!==this.DefaultInterpolation)this.setInterpolation(this.DefaultInterpolation);else throw new Error(n);return Vt("KeyframeTrack:",n),this}return this.createInterpolant=e,this}getInterpolation(){switch(this.createInterpolant){case this.InterpolantFactoryMethodDiscrete:return Tr;case this.InterpolantFactoryMethodLinear:return Ca;case this.InterpolantFactoryMethodSmooth:return xa;case this.InterpolantFactoryMethodBezier:return xh}}getValueSize(){return this.values.length/this.times.length}shift(t){if(t!==0){let e=this.times;for(let n=0,s=e.length;n!==s;++n)e[n]+=t;ma(this.settings)&&(Af(this.settings.inTangents,t),Af(this.settings.outTangents,t))}return this}scale(t){if(t!==1){let e=this.times;for(let n=0,s=e.length;n!==s;++n)e[n]*=t;ma(this.settings)&&(Tf(this.settings.inTangents,t),Tf(this.settings.outTangents,t))}return this}trim(t,e){let n=this.times,s=n.length,r=0,o=s-1;for(;r!==s&&n[r]<t;)++r;for(;o!==-1&&n[o]>e;)--o;if(++o,r!==0||o!==s){r>=o&&(o=Math.max(o,1),r=o-1);let a=this.getValueSize();this.times=n.slice(r,o),this.values=this.values.slice(r*a,o*a)}return this}validate(){let t=!0,e=this.getValueSize();e-Math.floor(e)!==0&&(Wt("KeyframeTrack: Invalid value size in track.",this),t=!1);let n=this.times,s=this.values,r=n.length;r===0&&(Wt("KeyframeTrack: Track is empty.",this),t=!1);let o=null;for(let a=0;a!==r;a++){let l=n[a];if(typeof l=="number"&&isNaN(l)){Wt("KeyframeTrack: Time is not a valid number.",this,a,l),t=!1;break}if(o!==null&&o>l){Wt("KeyframeTrack: Out of order keys.",this,a,l,o),t=!1;break}o=l}if(s!==void 0&&m0(s))for(let a=0,l=s.length;a!==l;++a){let c=s[a];if(isNaN(c)){Wt("KeyframeTrack: Value is not a valid number.",this,a,c),t=!1;break}}return t}optimize(){let t=this.times.slice(),e=this.values.slice(),n=this.getValueSize(),s=this.getInterpolation()===xa,r=t.length-1,o=1;for(let a=1;a<r;++a){let l=!1,c=t[a],h=t[a+1];if(c!==h&&(a!==1||c!==t[0]))if(s)l=!0;else{let u=a*n,d=u-n,f=u+n;for(let m=0;m!==n;++m){let x=e[u+m];if(x!==e[d+m]||x!==e[f+m]){l=!0;break}}}if(l){if(a!==o){t[o]=t[a];let u=a*n,d=o*n;for(let f=0;f!==n;++f)e[d+f]=e[u+f]}++o}}if(r>0){t[o]=t[r];for(let a=r*n,l=o*n,c=0;c!==n;++c)e[l+c]=e[a+c];++o}return o!==t.length?(this.times=t.slice(0,o),this.values=e.slice(0,o*n)):(this.times=t,this.values=e),this}clone(){let t=this.times.slice(),e=this.values.slice(),n=this.constructor,s=new n(this.name,t,e);return s.createInterpolant=this.createInterpolant,ma(this.settings)&&(s.settings={inTangents:this.settings.inTangents.slice(),outTangents:this.settings.outTangents.slice()}),s}};function Af(i,t){for(let e=0,n=i.length;e!==n;e+=2)i[e]+=t}function Tf(i,t){for(let e=0,n=i.length;e!==n;e+=2)i[e]*=t}yn.prototype.ValueTypeName="";yn.prototype.TimeBufferType=Float32Array;yn.prototype.ValueBufferType=Float32Array;yn.prototype.DefaultInterpolation=Ca;var zi=class extends yn{constructor(t,e,n){super(t,e,n)}};zi.prototype.ValueTypeName="bool";zi.prototype.ValueBufferType=Array;zi.prototype.DefaultInterpolation=Tr;zi.prototype.InterpolantFactoryMethodLinear=void 0;zi.prototype.InterpolantFactoryMethodSmooth=void 0;var Ja=class extends yn{constructor(t,e,n,s){super(t,e,n,s)}};Ja.prototype.ValueTypeName="color";var ja=class extends yn{constructor(t,e,n,s){super(t,e,n,s)}};ja.prototype.ValueTypeName="number";var Ka=class extends ki{constructor(t,e,n,s){super(t,e,n,s)}interpolate_(t,e,n,s){let r=this.resultBuffer,o=this.sampleValues,a=this.valueSize,l=(n-e)/(s-e),c=t*a;for(let h=c+a;c!==h;c+=4)Ue.slerpFlat(r,0,o,c-a,o,c,l);return r}},Jr=class extends yn{constructor(t,e,n,s){super(t,e,n,s)}InterpolantFactoryMethodLinear(t){return new Ka(this.times,this.values,this.getValueSize(),t)}};Jr.prototype.ValueTypeName="quaternion";Jr.prototype.InterpolantFactoryMethodSmooth=void 0;var Gi=class extends yn{constructor(t,e,n){super(t,e,n)}};Gi.prototype.ValueTypeName="string";Gi.prototype.ValueBufferType=Array;Gi.prototype.DefaultInterpolation=Tr;Gi.prototype.InterpolantFactoryMethodLinear=void 0;Gi.prototype.InterpolantFactoryMethodSmooth=void 0;var Qa=class extends yn{constructor(t,e,n,s){super(t,e,n,s)}};Qa.prototype.ValueTypeName="vector";var tl=class{constructor(t,e,n){let s=this,r=!1,o=0,a=0,l,c=[];this.onStart=void 0,this.onLoad=t,this.onProgress=e,this.onError=n,this._abortController=null,this.itemStart=function(h){a++,r===!1&&s.onStart!==void 0&&s.onStart(h,o,a),r=!0},this.itemEnd=function(h){o++,s.onProgress!==void 0&&s.onProgress(h,o,a),o===a&&(r=!1,s.onLoad!==void 0&&s.onLoad())},this.itemError=function(h){s.onError!==void 0&&s.onError(h)},this.resolveURL=function(h){return h=h.normalize("NFC"),l?l(h):h},this.setURLModifier=function(h){return l=h,this},this.addHandler=function(h,u){return c.push(h,u),this},this.removeHandler=function(h){let u=c.indexOf(h);return u!==-1&&c.splice(u,2),this},this.getHandler=function(h){for(let u=0,d=c.length;u<d;u+=2){let f=c[u],m=c[u+1];if(f.global&&(f.lastIndex=0),f.test(h))return m}return null},this.abort=function(){return this.abortController.abort(),this._abortController=null,this}}get abortController(){return this._abortController||(this._abortController=new AbortController),this._abortController}},yp=new tl,el=class{constructor(t){this.manager=t!==void 0?t:yp,this.crossOrigin="anonymous",this.withCredentials=!1,this.path="",this.resourcePath="",this.requestHeader={},this.priority="auto",this.cache="default",typeof __THREE_DEVTOOLS__<"u"&&__THREE_DEVTOOLS__.dispatchEvent(new CustomEvent("observe",{detail:this}))}load(){}loadAsync(t,e){let n=this;return new Promise(function(s,r){n.load(t,s,e,r)})}parse(){}setCrossOrigin(t){return this.crossOrigin=t,this}setWithCredentials(t){return this.withCredentials=t,this}setPath(t){return this.path=t,this}setResourcePath(t){return this.resourcePath=t,this}setRequestHeader(t){return this.requestHeader=t,this}setPriority(t){return this.priority=t,this}setCache(t){return this.cache=t,this}abort(){return this}};el.DEFAULT_MATERIAL_NAME="__DEFAULT";var ga=new I,_a=new Ue,$n=new I,jr=class extends dn{constructor(){super(),this.isCamera=!0,this.type="Camera",this.matrixWorldInverse=new ue,this.projectionMatrix=new ue,this.projectionMatrixInverse=new ue,this.coordinateSystem=Cn,this._reversedDepth=!1}get reversedDepth(){return this._reversedDepth}copy(t,e){return super.copy(t,e),this.matrixWorldInverse.copy(t.matrixWorldInverse),this.projectionMatrix.copy(t.projectionMatrix),this.projectionMatrixInverse.copy(t.projectionMatrixInverse),this.coordinateSystem=t.coordinateSystem,this}getWorldDirection(t){return super.getWorldDirection(t).negate()}updateMatrixWorld(t){super.updateMatrixWorld(t),this.matrixWorld.decompose(ga,_a,$n),$n.x===1&&$n.y===1&&$n.z===1?this.matrixWorldInverse.copy(this.matrixWorld).invert():this.matrixWorldInverse.compose(ga,_a,$n.set(1,1,1)).invert()}updateWorldMatrix(t,e,n=!1){super.updateWorldMatrix(t,e,n),this.matrixWorld.decompose(ga,_a,$n),$n.x===1&&$n.y===1&&$n.z===1?this.matrixWorldInverse.copy(this.matrixWorld).invert():this.matrixWorldInverse.compose(ga,_a,$n.set(1,1,1)).invert()}clone(){return new this.constructor().copy(this)}},Ui=new I,Cf=new rt,Rf=new rt,sn=class extends jr{constructor(t=50,e=1,n=.1,s=2e3){super(),this.isPerspectiveCamera=!0,this.type="PerspectiveCamera",this.fov=t,this.zoom=1,this.near=n,this.far=s,this.focus=10,this.aspect=e,this.view=null,this.filmGauge=35,this.filmOffset=0,this.updateProjectionMatrix()}copy(t,e){return super.copy(t,e),this.fov=t.fov,this.zoom=t.zoom,this.near=t.near,this.far=t.far,this.focus=t.focus,this.aspect=t.aspect,this.view=t.view===null?null:Object.assign({},t.view),this.filmGauge=t.filmGauge,this.filmOffset=t.filmOffset,this}setFocalLength(t){let e=.5*this.getFilmHeight()/t;this.fov=Fs*2*Math.atan(e),this.updateProjectionMatrix()}getFocalLength(){let t=Math.tan(Ds*.5*this.fov);return .5*this.getFilmHeight()/t}getEffectiveFOV(){return Fs*2*Math.atan(Math.tan(Ds*.5*this.fov)/this.zoom)}getFilmWidth(){return this.filmGauge*Math.min(this.aspect,1)}getFilmHeight(){return this.filmGauge/Math.max(this.aspect,1)}getViewBounds(t,e,n){Ui.set(-1,-1,.5).applyMatrix4(this.projectionMatrixInverse),e.set(Ui.x,Ui.y).multiplyScalar(-t/Ui.z),Ui.set(1,1,.5).applyMatrix4(this.projectionMatrixInverse),n.set(Ui.x,Ui.y).multiplyScalar(-t/Ui.z)}getViewSize(t,e){return this.getViewBounds(t,Cf,Rf),e.subVectors(Rf,Cf)}setViewOffset(t,e,n,s,r,o){this.aspect=t/e,this.view===null&&(this.view={enabled:!0,fullWidth:1,fullHeight:1,offsetX:0,offsetY:0,width:1,height:1}),this.view.enabled=!0,this.view.fullWidth=t,this.view.fullHeight=e,this.view.offsetX=n,this.view.offsetY=s,this.view.width=r,this.view.height=o,this.updateProjectionMatrix()}clearViewOffset(){this.view!==null&&(this.view.enabled=!1),this.updateProjectionMatrix()}updateProjectionMatrix(){let t=this.near,e=t*Math.tan(Ds*.5*this.fov)/this.zoom,n=2*e,s=this.aspect*n,r=-.5*s,o=this.view;if(this.view!==null&&this.view.enabled){let l=o.fullWidth,c=o.fullHeight;r+=o.offsetX*s/l,e-=o.offsetY*n/c,s*=o.width/l,n*=o.height/c}let a=this.filmOffset;a!==0&&(r+=t*a/this.getFilmWidth()),this.projectionMatrix.makePerspective(r,r+s,e,e-n,t,this.far,this.coordinateSystem,this.reversedDepth),this.projectionMatrixInverse.copy(this.projectionMatrix).invert()}toJSON(t){let e=super.toJSON(t);return e.object.fov=this.fov,e.object.zoom=this.zoom,e.object.near=this.near,e.object.far=this.far,e.object.focus=this.focus,e.object.aspect=this.aspect,this.view!==null&&(e.object.view=Object.assign({},this.view)),e.object.filmGauge=this.filmGauge,e.object.filmOffset=this.filmOffset,e}};var Xs=class extends jr{constructor(t=-1,e=1,n=1,s=-1,r=.1,o=2e3){super(),this.isOrthographicCamera=!0,this.type="OrthographicCamera",this.zoom=1,this.view=null,this.left=t,this.right=e,this.top=n,this.bottom=s,this.near=r,this.far=o,this.updateProjectionMatrix()}copy(t,e){return super.copy(t,e),this.left=t.left,this.right=t.right,this.top=t.top,this.bottom=t.bottom,this.near=t.near,this.far=t.far,this.zoom=t.zoom,this.view=t.view===null?null:Object.assign({},t.view),this}setViewOffset(t,e,n,s,r,o){this.view===null&&(this.view={enabled:!0,fullWidth:1,fullHeight:1,offsetX:0,offsetY:0,width:1,height:1}),this.view.enabled=!0,this.view.fullWidth=t,this.view.fullHeight=e,this.view.offsetX=n,this.view.offsetY=s,this.view.width=r,this.view.height=o,this.updateProjectionMatrix()}clearViewOffset(){this.view!==null&&(this.view.enabled=!1),this.updateProjectionMatrix()}updateProjectionMatrix(){let t=(this.right-this.left)/(2*this.zoom),e=(this.top-this.bottom)/(2*this.zoom),n=(this.right+this.left)/2,s=(this.top+this.bottom)/2,r=n-t,o=n+t,a=s+e,l=s-e;if(this.view!==null&&this.view.enabled){let c=(this.right-this.left)/this.view.fullWidth/this.zoom,h=(this.top-this.bottom)/this.view.fullHeight/this.zoom;r+=c*this.view.offsetX,o=r+c*this.view.width,a-=h*this.view.offsetY,l=a-h*this.view.height}this.projectionMatrix.makeOrthographic(r,o,a,l,this.near,this.far,this.coordinateSystem,this.reversedDepth),this.projectionMatrixInverse.copy(this.projectionMatrix).invert()}toJSON(t){let e=super.toJSON(t);return e.object.zoom=this.zoom,e.object.left=this.left,e.object.right=this.right,e.object.top=this.top,e.object.bottom=this.bottom,e.object.near=this.near,e.object.far=this.far,this.view!==null&&(e.object.view=Object.assign({},this.view)),e}};var Ps=-90,Is=1,qs=class extends dn{constructor(t,e,n){super(),this.type="CubeCamera",this.renderTarget=n,this.coordinateSystem=null,this.activeMipmapLevel=0;let s=new sn(Ps,Is,t,e);s.layers=this.layers,this.add(s);let r=new sn(Ps,Is,t,e);r.layers=this.layers,this.add(r);let o=new sn(Ps,Is,t,e);o.layers=this.layers,this.add(o);let a=new sn(Ps,Is,t,e);a.layers=this.layers,this.add(a);let l=new sn(Ps,Is,t,e);l.layers=this.layers,this.add(l);let c=new sn(Ps,Is,t,e);c.layers=this.layers,this.add(c)}updateCoordinateSystem(){let t=this.coordinateSystem,e=this.children.concat(),[n,s,r,o,a,l]=e;for(let c of e)this.remove(c);if(t===Cn)n.up.set(0,1,0),n.lookAt(1,0,0),s.up.set(0,1,0),s.lookAt(-1,0,0),r.up.set(0,0,-1),r.lookAt(0,1,0),o.up.set(0,0,1),o.lookAt(0,-1,0),a.up.set(0,1,0),a.lookAt(0,0,1),l.up.set(0,1,0),l.lookAt(0,0,-1);else if(t===Rr)n.up.set(0,-1,0),n.lookAt(-1,0,0),s.up.set(0,-1,0),s.lookAt(1,0,0),r.up.set(0,0,1),r.lookAt(0,1,0),o.up.set(0,0,-1),o.lookAt(0,-1,0),a.up.set(0,-1,0),a.lookAt(0,0,1),l.up.set(0,-1,0),l.lookAt(0,0,-1);else throw new Error("THREE.CubeCamera.updateCoordinateSystem(): Invalid coordinate system: "+t);for(let c of e)this.add(c),c.updateMatrixWorld()}update(t,e){this.parent===null&&this.updateMatrixWorld();let{renderTarget:n,activeMipmapLevel:s}=this;this.coordinateSystem!==t.coordinateSystem&&(this.coordinateSystem=t.coordinateSystem,this.updateCoordinateSystem());let[r,o,a,l,c,h]=this.children,u=t.getRenderTarget(),d=t.getActiveCubeFace(),f=t.getActiveMipmapLevel(),m=t.xr.enabled;t.xr.enabled=!1;let x=n.texture.mipmapsAutoUpdate;n.texture.mipmapsAutoUpdate=!1;let p=!1;t.isWebGLRenderer===!0?p=t.state.buffers.depth.getReversed():p=t.reversedDepthBuffer,t.setRenderTarget(n,0,s),p&&t.autoClear===!1&&t.clearDepth(),t.render(e,r),t.setRenderTarget(n,1,s),p&&t.autoClear===!1&&t.clearDepth(),t.render(e,o),t.setRenderTarget(n,2,s),p&&t.autoClear===!1&&t.clearDepth(),t.render(e,a),t.setRenderTarget(n,3,s),p&&t.autoClear===!1&&t.clearDepth(),t.render(e,l),t.setRenderTarget(n,4,s),p&&t.autoClear===!1&&t.clearDepth(),t.render(e,c),n.texture.mipmapsAutoUpdate=x,t.setRenderTarget(n,5,s),p&&t.autoClear===!1&&t.clearDepth(),t.render(e,h),t.setRenderTarget(u,d,f),t.xr.enabled=m,n.texture.needsPMREMUpdate=!0}},nl=class extends sn{constructor(t=[]){super(),this.isArrayCamera=!0,this.isMultiViewCamera=!1,this.cameras=t,this.perCameraFrustumCulled=!1}};var uu="\\[\\]\\.:\\/",C_=new RegExp("["+uu+"]","g"),du="[^"+uu+"]",R_="[^"+uu.replace("\\.","")+"]",P_=/((?:WC+[\/:])*)/.source.replace("WC",du),I_=/(WCOD+)?/.source.replace("WCOD",R_),L_=/(?:\.(WC+)(?:\[(.+)\])?)?/.source.replace("WC",du),D_=/\.(WC+)(?:\[(.+)\])?/.source.replace("WC",du),N_=new RegExp("^"+P_+I_+L_+D_+"$"),U_=["material","materials","bones","map"],Th=class{constructor(t,e,n){let s=n||Ae.parseTrackName(e);this._targetGroup=t,this._bindings=t.subscribe_(e,s)}getValue(t,e){this.bind();let n=this._targetGroup.nCachedObjects_,s=this._bindings[n];s!==void 0&&s.getValue(t,e)}setValue(t,e){let n=this._bindings;for(let s=this._targetGroup.nCachedObjects_,r=n.length;s!==r;++s)n[s].setValue(t,e)}bind(){let t=this._bindings;for(let e=this._targetGroup.nCachedObjects_,n=t.length;e!==n;++e)t[e].bind()}unbind(){let t=this._bindings;for(let e=this._targetGroup.nCachedObjects_,n=t.length;e!==n;++e)t[e].unbind()}},Ae=class i{constructor(t,e,n){this.path=e,this.parsedPath=n||i.parseTrackName(e),this.node=i.findNode(t,this.parsedPath.nodeName),this.rootNode=t,this.getValue=this._getValue_unbound,this.setValue=this._setValue_unbound}static create(t,e,n){return t&&t.isAnimationObjectGroup?new i.Composite(t,e,n):new i(t,e,n)}static sanitizeNodeName(t){return t.replace(/\s/g,"_").replace(C_,"")}static parseTrackName(t){let e=N_.exec(t);if(e===null)throw new Error("THREE.PropertyBinding: Cannot parse trackName: "+t);let n={nodeName:e[2],objectName:e[3],objectIndex:e[4],propertyName:e[5],propertyIndex:e[6]},s=n.nodeName&&n.nodeName.lastIndexOf(".");if(s!==void 0&&s!==-1){let r=n.nodeName.substring(s+1);U_.indexOf(r)!==-1&&(n.nodeName=n.nodeName.substring(0,s),n.objectName=r)}if(n.propertyName===null||n.propertyName.length===0)throw new Error("THREE.PropertyBinding: can not parse propertyName from trackName: "+t);return n}static findNode(t,e){if(e===void 0||e===""||e==="."||e===-1||e===t.name||e===t.uuid)return t;if(t.skeleton){let n=t.skeleton.getBoneByName(e);if(n!==void 0)return n}if(t.children){let n=function(r){for(let o=0;o<r.length;o++){let a=r[o];if(a.name===e||a.uuid===e)return a;let l=n(a.children);if(l)return l}return null},s=n(t.children);if(s)return s}return null}_getValue_unavailable(){}_setValue_unavailable(){}_getValue_direct(t,e){t[e]=this.targetObject[this.propertyName]}_getValue_array(t,e){let n=this.resolvedProperty;for(let s=0,r=n.length;s!==r;++s)t[e++]=n[s]}_getValue_arrayElement(t,e){t[e]=this.resolvedProperty[this.propertyIndex]}_getValue_toArray(t,e){this.resolvedProperty.toArray(t,e)}_setValue_direct(t,e){this.targetObject[this.propertyName]=t[e]}_setValue_direct_setNeedsUpdate(t,e){this.targetObject[this.propertyName]=t[e],this.targetObject.needsUpdate=!0}_setValue_direct_setMatrixWorldNeedsUpdate(t,e){this.targetObject[this.propertyName]=t[e],this.targetObject.matrixWorldNeedsUpdate=!0}_setValue_array(t,e){let n=this.resolvedProperty;for(let s=0,r=n.length;s!==r;++s)n[s]=t[e++]}_setValue_array_setNeedsUpdate(t,e){let n=this.resolvedProperty;for(let s=0,r=n.length;s!==r;++s)n[s]=t[e++];this.targetObject.needsUpdate=!0}_setValue_array_setMatrixWorldNeedsUpdate(t,e){let n=this.resolvedProperty;for(let s=0,r=n.length;s!==r;++s)n[s]=t[e++];this.targetObject.matrixWorldNeedsUpdate=!0}_setValue_arrayElement(t,e){this.resolvedProperty[this.propertyIndex]=t[e]}_setValue_arrayElement_setNeedsUpdate(t,e){this.resolvedProperty[this.propertyIndex]=t[e],this.targetObject.needsUpdate=!0}_setValue_arrayElement_setMatrixWorldNeedsUpdate(t,e){this.resolvedProperty[this.propertyIndex]=t[e],this.targetObject.matrixWorldNeedsUpdate=!0}_setValue_fromArray(t,e){this.resolvedProperty.fromArray(t,e)}_setValue_fromArray_setNeedsUpdate(t,e){this.resolvedProperty.fromArray(t,e),this.targetObject.needsUpdate=!0}_setValue_fromArray_setMatrixWorldNeedsUpdate(t,e){this.resolvedProperty.fromArray(t,e),this.targetObject.matrixWorldNeedsUpdate=!0}_getValue_unbound(t,e){this.bind(),this.getValue(t,e)}_setValue_unbound(t,e){this.bind(),this.setValue(t,e)}bind(){let t=this.node,e=this.parsedPath,n=e.objectName,s=e.propertyName,r=e.propertyIndex;if(t||(t=i.findNode(this.rootNode,e.nodeName),this.node=t),this.getValue=this._getValue_unavailable,this.setValue=this._setValue_unavailable,!t){Vt("PropertyBinding: No target node found for track: "+this.path+".");return}if(n){let c=e.objectIndex;switch(n){case"materials":if(!t.material){Wt("PropertyBinding: Can not bind to material as node does not have a material.",this);return}if(!t.material.materials){Wt("PropertyBinding: Can not bind to material.materials as node.material does not have a materials array.",this);return}t=t.material.materials;break;case"bones":if(!t.skeleton){Wt("PropertyBinding: Can not bind to bones as node does not have a skeleton.",this);return}t=t.skeleton.bones;for(let h=0;h<t.length;h++)if(t[h].name===c){c=h;break}break;case"map":if("map"in t){t=t.map;break}if(!t.material){Wt("PropertyBinding: Can not bind to material as node does not have a material.",this);return}if(!t.material.map){Wt("PropertyBinding: Can not bind to material.map as node.material does not have a map.",this);return}t=t.material.map;break;default:if(t[n]===void 0){Wt("PropertyBinding: Can not bind to objectName of node undefined.",this);return}t=t[n]}if(c!==void 0){if(t[c]===void 0){Wt("PropertyBinding: Trying to bind to objectIndex of objectName, but is undefined.",this,t);return}t=t[c]}}let o=t[s];if(o===void 0){let c=e.nodeName;Wt("PropertyBinding: Trying to update property for track: "+c+"."+s+" but it wasn't found.",t);return}let a=this.Versioning.None;this.targetObject=t,t.isMaterial===!0?a=this.Versioning.NeedsUpdate:t.isObject3D===!0&&(a=this.Versioning.MatrixWorldNeedsUpdate);let l=this.BindingType.Direct;if(r!==void 0){if(s==="morphTargetInfluences"){if(!t.geometry){Wt("PropertyBinding: Can not bind to morphTargetInfluences because node does not have a geometry.",this);return}if(!t.geometry.morphAttributes){Wt("PropertyBinding: Can not bind to morphTargetInfluences because node does not have a geometry.morphAttributes.",this);return}t.morphTargetDictionary[r]!==void 0&&(r=t.morphTargetDictionary[r])}l=this.BindingType.ArrayElement,this.resolvedProperty=o,this.propertyIndex=r}else o.fromArray!==void 0&&o.toArray!==void 0?(l=this.BindingType.HasFromToArray,this.resolvedProperty=o):Array.isArray(o)?(l=this.BindingType.EntireArray,this.resolvedProperty=o):this.propertyName=s;this.getValue=this.GetterByBindingType[l],this.setValue=this.SetterByBindingTypeAndVersioning[l][a]}unbind(){this.node=null,this.getValue=this._getValue_unbound,this.setValue=this._setValue_unbound}};Ae.Composite=Th;Ae.prototype.BindingType={Direct:0,EntireArray:1,ArrayElement:2,HasFromToArray:3};Ae.prototype.Versioning={None:0,NeedsUpdate:1,MatrixWorldNeedsUpdate:2};Ae.prototype.GetterByBindingType=[Ae.prototype._getValue_direct,Ae.prototype._getValue_array,Ae.prototype._getValue_arrayElement,Ae.prototype._getValue_toArray];Ae.prototype.SetterByBindingTypeAndVersioning=[[Ae.prototype._setValue_direct,Ae.prototype._setValue_direct_setNeedsUpdate,Ae.prototype._setValue_direct_setMatrixWorldNeedsUpdate],[Ae.prototype._setValue_array,Ae.prototype._setValue_array_setNeedsUpdate,Ae.prototype._setValue_array_setMatrixWorldNeedsUpdate],[Ae.prototype._setValue_arrayElement,Ae.prototype._setValue_arrayElement_setNeedsUpdate,Ae.prototype._setValue_arrayElement_setMatrixWorldNeedsUpdate],[Ae.prototype._setValue_fromArray,Ae.prototype._setValue_fromArray_setNeedsUpdate,Ae.prototype._setValue_fromArray_setMatrixWorldNeedsUpdate]];var A1=new Float32Array(1);var Pf=new ue,Kr=class{constructor(t,e,n=0,s=1/0){this.ray=new xi(t,e),this.near=n,this.far=s,this.camera=null,this.layers=new ks,this.params={Mesh:{},Line:{threshold:1},LOD:{},Points:{threshold:1},Sprite:{}}}set(t,e){this.ray.set(t,e)}setFromCamera(t,e){e.isPerspectiveCamera?(this.ray.origin.setFromMatrixPosition(e.matrixWorld),this.ray.direction.set(t.x,t.y,.5).unproject(e).sub(this.ray.origin).normalize(),this.camera=e):e.isOrthographicCamera?(this.ray.origin.set(t.x,t.y,e.projectionMatrix.elements[14]).unproject(e),this.ray.direction.set(0,0,-1).transformDirection(e.matrixWorld),this.camera=e):Wt("Raycaster: Unsupported camera type: "+e.type)}setFromXRController(t){return Pf.identity().extractRotation(t.matrixWorld),this.ray.origin.setFromMatrixPosition(t.matrixWorld),this.ray.direction.set(0,0,-1).applyMatrix4(Pf),this}intersectObject(t,e=!0,n=[]){return Ch(t,this,n,e),n.sort(If),n}intersectObjects(t,e=!0,n=[]){for(let s=0,r=t.length;s<r;s++)Ch(t[s],this,n,e);return n.sort(If),n}};function If(i,t){return i.distance-t.distance}function Ch(i,t,e,n){let s=!0;if(i.layers.test(t.layers)&&i.raycast(t,e)===!1&&(s=!1),s===!0&&n===!0){let r=i.children;for(let o=0,a=r.length;o<a;o++)Ch(r[o],t,e,!0)}}var Qn=class{constructor(t=1,e=0,n=0){this.radius=t,this.phi=e,this.theta=n}set(t,e,n){return this.radius=t,this.phi=e,this.theta=n,this}copy(t){return this.radius=t.radius,this.phi=t.phi,this.theta=t.theta,this}makeSafe(){return this.phi=ee(this.phi,1e-6,Math.PI-1e-6),this}setFromVector3(t){return this.setFromCartesianCoords(t.x,t.y,t.z)}setFromCartesianCoords(t,e,n){return this.radius=Math.sqrt(t*t+e*e+n*n),this.radius===0?(this.theta=0,this.phi=0):(this.theta=Math.atan2(t,n),this.phi=Math.acos(ee(e/this.radius,-1,1))),this}clone(){return new this.constructor().copy(this)}};var Rh=class{static{this.prototype.isMatrix2=!0}constructor(t,e,n,s){this.elements=[1,0,0,1],t!==void 0&&this.set(t,e,n,s)}identity(){return this.set(1,0,0,1),this}fromArray(t,e=0){for(let n=0;n<4;n++)this.elements[n]=t[n+e];return this}set(t,e,n,s){let r=this.elements;return r[0]=t,r[2]=e,r[1]=n,r[3]=s,this}};var Qr=class extends Bn{constructor(t,e=null){super(),this.object=t,this.domElement=e,this.enabled=!0,this.state=-1,this.keys={},this.mouseButtons={LEFT:null,MIDDLE:null,RIGHT:null},this.touches={ONE:null,TWO:null}}connect(t){this.domElement!==null&&this.disconnect(),this.domElement=t}disconnect(){}dispose(){}update(){}};function fu(i,t,e,n){let s=O_(n);switch(e){case Zh:return i*t;case ul:return i*t/s.components*s.byteLength;case dl:return i*t/s.components*s.byteLength;case Wi:return i*t*2/s.components*s.byteLength;case fl:return i*t*2/s.components*s.byteLength;case Jh:return i*t*3/s.components*s.byteLength;case Sn:return i*t*4/s.components*s.byteLength;case pl:return i*t*4/s.components*s.byteLength;case io:case so:return Math.floor((i+3)/4)*Math.floor((t+3)/4)*8;case ro:case oo:return Math.floor((i+3)/4)*Math.floor((t+3)/4)*16;case gl:case xl:return Math.max(i,16)*Math.max(t,8)/4;case ml:case _l:return Math.max(i,8)*Math.max(t,8)/2;case vl:case yl:case Ml:case Sl:return Math.floor((i+3)/4)*Math.floor((t+3)/4)*8;case bl:case ao:case wl:return Math.floor((i+3)/4)*Math.floor((t+3)/4)*16;case El:return Math.floor((i+3)/4)*Math.floor((t+3)/4)*16;case Al:return Math.floor((i+4)/5)*Math.floor((t+3)/4)*16;case Tl:return Math.floor((i+4)/5)*Math.floor((t+4)/5)*16;case Cl:return Math.floor((i+5)/6)*Math.floor((t+4)/5)*16;case Rl:return Math.floor((i+5)/6)*Math.floor((t+5)/6)*16;case Pl:return Math.floor((i+7)/8)*Math.floor((t+4)/5)*16;case Il:return Math.floor((i+7)/8)*Math.floor((t+5)/6)*16;case Ll:return Math.floor((i+7)/8)*Math.floor((t+7)/8)*16;case Dl:return Math.floor((i+9)/10)*Math.floor((t+4)/5)*16;case Nl:return Math.floor((i+9)/10)*Math.floor((t+5)/6)*16;case Ul:return Math.floor((i+9)/10)*Math.floor((t+7)/8)*16;case Ol:return Math.floor((i+9)/10)*Math.floor((t+9)/10)*16;case Fl:return Math.floor((i+11)/12)*Math.floor((t+9)/10)*16;case Bl:return Math.floor((i+11)/12)*Math.floor((t+11)/12)*16;case kl:case zl:case Gl:return Math.ceil(i/4)*Math.ceil(t/4)*16;case Vl:case Hl:return Math.ceil(i/4)*Math.ceil(t/4)*8;case lo:case Wl:return Math.ceil(i/4)*Math.ceil(t/4)*16}throw new Error(`Unable to determine texture byte length for ${e} format.`)}function O_(i){switch(i){case Mn:case Xh:return{byteLength:1,components:1};case Js:case qh:case zn:return{byteLength:2,components:1};case cl:case hl:return{byteLength:2,components:4};case kn:case ll:case fn:return{byteLength:4,components:1};case $h:case Yh:return{byteLength:4,components:3}}throw new Error(`THREE.TextureUtils: Unknown texture type ${i}.`)}typeof __THREE_DEVTOOLS__<"u"&&__THREE_DEVTOOLS__.dispatchEvent(new CustomEvent("register",{detail:{revision:"187"}}));typeof window<"u"&&(window.__THREE__?Vt("WARNING: Multiple instances of Three.js being imported."):window.__THREE__="187");function Vp(){let i=null,t=!1,e=null,n=null;function s(r,o){n=i.requestAnimationFrame(s),e(r,o)}return{start:function(){t!==!0&&e!==null&&i!==null&&(n=i.requestAnimationFrame(s),t=!0)},stop:function(){i!==null&&i.cancelAnimationFrame(n),t=!1},setAnimationLoop:function(r){e=r},setContext:function(r){i=r}}}function B_(i){let t=new WeakMap;function e(a,l){let c=a.array,h=a.usage,u=c.byteLength,d=i.createBuffer();i.bindBuffer(l,d),i.bufferData(l,c,h),a.onUploadCallback();let f;if(c instanceof Float32Array)f=i.FLOAT;else if(typeof Float16Array<"u"&&c instanceof Float16Array)f=i.HALF_FLOAT;else if(c instanceof Uint16Array)a.isFloat16BufferAttribute?f=i.HALF_FLOAT:f=i.UNSIGNED_SHORT;else if(c instanceof Int16Array)f=i.SHORT;else if(c instanceof Uint32Array)f=i.UNSIGNED_INT;else if(c instanceof Int32Array)f=i.INT;else if(c instanceof Int8Array)f=i.BYTE;else if(c instanceof Uint8Array)f=i.UNSIGNED_BYTE;else if(c instanceof Uint8ClampedArray)f=i.UNSIGNED_BYTE;else throw new Error("THREE.WebGLAttributes: Unsupported buffer data format: "+c);return{buffer:d,type:f,bytesPerElement:c.BYTES_PER_ELEMENT,version:a.version,size:u}}function n(a,l,c){let h=l.array,u=l.updateRanges;if(i.bindBuffer(c,a),u.length===0)i.bufferSubData(c,0,h);else{u.sort((f,m)=>f.start-m.start);let d=0;for(let f=1;f<u.length;f++){let m=u[d],x=u[f];x.start<=m.start+m.count+1?m.count=Math.max(m.count,x.start+x.count-m.start):(++d,u[d]=x)}u.length=d+1;for(let f=0,m=u.length;f<m;f++){let x=u[f];i.bufferSubData(c,x.start*h.BYTES_PER_ELEMENT,h,x.start,x.count)}l.clearUpdateRanges()}l.onUploadCallback()}function s(a){return a.isInterleavedBufferAttribute&&(a=a.data),t.get(a)}function r(a){a.isInterleavedBufferAttribute&&(a=a.data);let l=t.get(a);l&&(i.deleteBuffer(l.buffer),t.delete(a))}function o(a,l){if(a.isInterleavedBufferAttribute&&(a=a.data),a.isGLBufferAttribute){let h=t.get(a);(!h||h.version<a.version)&&t.set(a,{buffer:a.buffer,type:a.type,bytesPerElement:a.elementSize,version:a.version});return}let c=t.get(a);if(c===void 0)t.set(a,e(a,l));else if(c.version<a.version){if(c.size!==a.array.byteLength)throw new Error("THREE.WebGLAttributes: The size of the buffer attribute's array buffer does not match the original size. Resizing buffer attributes is not supported.");n(c.buffer,a,l),c.version=a.version}}return{get:s,remove:r,update:o}}var k_=`#ifdef USE_ALPHAHASH
	if ( diffuseColor.a < getAlphaHashThreshold( vPosition ) ) discard;
#endif`,z_=`#ifdef USE_ALPHAHASH
	const float ALPHA_HASH_SCALE = 0.05;
	float hash2D( vec2 value ) {
		return fract( 1.0e4 * sin( 17.0 * value.x + 0.1 * value.y ) * ( 0.1 + abs( sin( 13.0 * value.y + value.x ) ) ) );
	}
	float hash3D( vec3 value ) {
		return hash2D( vec2( hash2D( value.xy ), value.z ) );
	}
	float getAlphaHashThreshold( vec3 position ) {
		float maxDeriv = max(
			length( dFdx( position.xyz ) ),
			length( dFdy( position.xyz ) )
		);
		float pixScale = 1.0 / ( ALPHA_HASH_SCALE * maxDeriv );
		vec2 pixScales = vec2(
			exp2( floor( log2( pixScale ) ) ),
			exp2( ceil( log2( pixScale ) ) )
		);
		vec2 alpha = vec2(
			hash3D( floor( pixScales.x * position.xyz ) ),
			hash3D( floor( pixScales.y * position.xyz ) )
		);
		float lerpFactor = fract( log2( pixScale ) );
		float x = ( 1.0 - lerpFactor ) * alpha.x + lerpFactor * alpha.y;
		float a = min( lerpFactor, 1.0 - lerpFactor );
		vec3 cases = vec3(
			x * x / ( 2.0 * a * ( 1.0 - a ) ),
			( x - 0.5 * a ) / ( 1.0 - a ),
			1.0 - ( ( 1.0 - x ) * ( 1.0 - x ) / ( 2.0 * a * ( 1.0 - a ) ) )
		);
		float threshold = ( x < ( 1.0 - a ) )
			? ( ( x < a ) ? cases.x : cases.y )
			: cases.z;
		return clamp( threshold , 1.0e-6, 1.0 );
	}
#endif`,G_=`#ifdef USE_ALPHAMAP
	diffuseColor.a *= texture2D( alphaMap, vAlphaMapUv ).g;
#endif`,V_=`#ifdef USE_ALPHAMAP
	uniform sampler2D alphaMap;
#endif`,H_=`#ifdef USE_ALPHATEST
	#ifdef ALPHA_TO_COVERAGE
	diffuseColor.a = smoothstep( alphaTest, alphaTest + fwidth( diffuseColor.a ), diffuseColor.a );
	if ( diffuseColor.a == 0.0 ) discard;
	#else
	if ( diffuseColor.a < alphaTest ) discard;
	#endif
#endif`,W_=`#ifdef USE_ALPHATEST
	uniform float alphaTest;
#endif`,X_=`#ifdef USE_AOMAP
	float ambientOcclusion = ( texture2D( aoMap, vAoMapUv ).r - 1.0 ) * aoMapIntensity + 1.0;
	reflectedLight.indirectDiffuse *= ambientOcclusion;
	#if defined( USE_CLEARCOAT ) 
		clearcoatSpecularIndirect *= ambientOcclusion;
	#endif
	#if defined( USE_SHEEN ) 
		sheenSpecularIndirect *= ambientOcclusion;
	#endif
	#if defined( USE_ENVMAP ) && defined( STANDARD )
		float dotNV = saturate( dot( geometryNormal, geometryViewDir ) );
		reflectedLight.indirectSpecular *= computeSpecularOcclusion( dotNV, ambientOcclusion, material.roughness );
	#endif
#endif`,q_=`#ifdef USE_AOMAP
	uniform sampler2D aoMap;
	uniform float aoMapIntensity;
#endif`,$_=`#ifdef USE_BATCHING
	#if ! defined( GL_ANGLE_multi_draw )
	#define gl_DrawID _gl_DrawID
	uniform int _gl_DrawID;
	#endif
	uniform highp sampler2D batchingTexture;
	uniform highp usampler2D batchingIdTexture;
	mat4 getBatchingMatrix( const in float i ) {
		int size = textureSize( batchingTexture, 0 ).x;
		int j = int( i ) * 4;
		int x = j % size;
		int y = j / size;
		vec4 v1 = texelFetch( batchingTexture, ivec2( x, y ), 0 );
		vec4 v2 = texelFetch( batchingTexture, ivec2( x + 1, y ), 0 );
		vec4 v3 = texelFetch( batchingTexture, ivec2( x + 2, y ), 0 );
		vec4 v4 = texelFetch( batchingTexture, ivec2( x + 3, y ), 0 );
		return mat4( v1, v2, v3, v4 );
	}
	float getIndirectIndex( const in int i ) {
		int size = textureSize( batchingIdTexture, 0 ).x;
		int x = i % size;
		int y = i / size;
		return float( texelFetch( batchingIdTexture, ivec2( x, y ), 0 ).r );
	}
#endif
#ifdef USE_BATCHING_COLOR
	uniform sampler2D batchingColorTexture;
	vec4 getBatchingColor( const in float i ) {
		int size = textureSize( batchingColorTexture, 0 ).x;
		int j = int( i );
		int x = j % size;
		int y = j / size;
		return texelFetch( batchingColorTexture, ivec2( x, y ), 0 );
	}
#endif`,Y_=`#ifdef USE_BATCHING
	mat4 batchingMatrix = getBatchingMatrix( getIndirectIndex( gl_DrawID ) );
#endif`,Z_=`vec3 transformed = vec3( position );
#ifdef USE_ALPHAHASH
	vPosition = vec3( position );
#endif`,J_=`vec3 objectNormal = vec3( normal );
#ifdef USE_TANGENT
	vec3 objectTangent = vec3( tangent.xyz );
#endif`,j_=`float G_BlinnPhong_Implicit( ) {
	return 0.25;
}
float D_BlinnPhong( const in float shininess, const in float dotNH ) {
	return RECIPROCAL_PI * ( shininess * 0.5 + 1.0 ) * pow( dotNH, shininess );
}
vec3 BRDF_BlinnPhong( const in vec3 lightDir, const in vec3 viewDir, const in vec3 normal, const in vec3 specularColor, const in float shininess ) {
	vec3 halfDir = normalize( lightDir + viewDir );
	float dotNH = saturate( dot( normal, halfDir ) );
	float dotVH = saturate( dot( viewDir, halfDir ) );
	vec3 F = F_Schlick( specularColor, 1.0, dotVH );
	float G = G_BlinnPhong_Implicit( );
	float D = D_BlinnPhong( shininess, dotNH );
	return F * ( G * D );
} // validated`,K_=`#ifdef USE_IRIDESCENCE
	const mat3 XYZ_TO_REC709 = mat3(
		 3.2404542, -0.9692660,  0.0556434,
		-1.5371385,  1.8760108, -0.2040259,
		-0.4985314,  0.0415560,  1.0572252
	);
	vec3 Fresnel0ToIor( vec3 fresnel0 ) {
		vec3 sqrtF0 = sqrt( fresnel0 );
		return ( vec3( 1.0 ) + sqrtF0 ) / ( vec3( 1.0 ) - sqrtF0 );
	}
	vec3 IorToFresnel0( vec3 transmittedIor, float incidentIor ) {
		return pow2( ( transmittedIor - vec3( incidentIor ) ) / ( transmittedIor + vec3( incidentIor ) ) );
	}
	float IorToFresnel0( float transmittedIor, float incidentIor ) {
		return pow2( ( transmittedIor - incidentIor ) / ( transmittedIor + incidentIor ));
	}
	vec3 evalSensitivity( float OPD, vec3 shift ) {
		float phase = 2.0 * PI * OPD * 1.0e-9;
		vec3 val = vec3( 5.4856e-13, 4.4201e-13, 5.2481e-13 );
		vec3 pos = vec3( 1.6810e+06, 1.7953e+06, 2.2084e+06 );
		vec3 var = vec3( 4.3278e+09, 9.3046e+09, 6.6121e+09 );
		vec3 xyz = val * sqrt( 2.0 * PI * var ) * cos( pos * phase + shift ) * exp( - pow2( phase ) * var );
		xyz.x += 9.7470e-14 * sqrt( 2.0 * PI * 4.5282e+09 ) * cos( 2.2399e+06 * phase + shift[ 0 ] ) * exp( - 4.5282e+09 * pow2( phase ) );
		xyz /= 1.0685e-7;
		vec3 rgb = XYZ_TO_REC709 * xyz;
		return rgb;
	}
	vec3 evalIridescence( float outsideIOR, float eta2, float cosTheta1, float thinFilmThickness, vec3 baseF0 ) {
		vec3 I;
		float iridescenceIOR = mix( outsideIOR, eta2, smoothstep( 0.0, 0.03, thinFilmThickness ) );
		float sinTheta2Sq = pow2( outsideIOR / iridescenceIOR ) * ( 1.0 - pow2( cosTheta1 ) );
		float cosTheta2Sq = 1.0 - sinTheta2Sq;
		if ( cosTheta2Sq < 0.0 ) {
			return vec3( 1.0 );
		}
		float cosTheta2 = sqrt( cosTheta2Sq );
		float R0 = IorToFresnel0( iridescenceIOR, outsideIOR );
		float R12 = F_Schlick( R0, 1.0, cosTheta1 );
		float T121 = 1.0 - R12;
		float phi12 = 0.0;
		if ( iridescenceIOR < outsideIOR ) phi12 = PI;
		float phi21 = PI - phi12;
		vec3 baseIOR = Fresnel0ToIor( clamp( baseF0, 0.0, 0.9999 ) );		vec3 R1 = IorToFresnel0( baseIOR, iridescenceIOR );
		vec3 R23 = F_Schlick( R1, 1.0, cosTheta2 );
		vec3 phi23 = vec3( 0.0 );
		if ( baseIOR[ 0 ] < iridescenceIOR ) phi23[ 0 ] = PI;
		if ( baseIOR[ 1 ] < iridescenceIOR ) phi23[ 1 ] = PI;
		if ( baseIOR[ 2 ] < iridescenceIOR ) phi23[ 2 ] = PI;
		float OPD = 2.0 * iridescenceIOR * thinFilmThickness * cosTheta2;
		vec3 phi = vec3( phi21 ) + phi23;
		vec3 R123 = clamp( R12 * R23, 1e-5, 0.9999 );
		vec3 r123 = sqrt( R123 );
		vec3 Rs = pow2( T121 ) * R23 / ( vec3( 1.0 ) - R123 );
		vec3 C0 = R12 + Rs;
		I = C0;
		vec3 Cm = Rs - T121;
		for ( int m = 1; m <= 2; ++ m ) {
			Cm *= r123;
			vec3 Sm = 2.0 * evalSensitivity( float( m ) * OPD, float( m ) * phi );
			I += Cm * Sm;
		}
		return max( I, vec3( 0.0 ) );
	}
#endif`,Q_=`#ifdef USE_BUMPMAP
	uniform sampler2D bumpMap;
	uniform float bumpScale;
	vec2 dHdxy_fwd() {
		vec2 dSTdx = dFdx( vBumpMapUv );
		vec2 dSTdy = dFdy( vBumpMapUv );
		float Hll = bumpScale * texture2D( bumpMap, vBumpMapUv ).x;
		float dBx = bumpScale * texture2D( bumpMap, vBumpMapUv + dSTdx ).x - Hll;
		float dBy = bumpScale * texture2D( bumpMap, vBumpMapUv + dSTdy ).x - Hll;
		return vec2( dBx, dBy );
	}
	vec3 perturbNormalArb( vec3 surf_pos, vec3 surf_norm, vec2 dHdxy, float faceDirection ) {
		vec3 vSigmaX = normalize( dFdx( surf_pos.xyz ) );
		vec3 vSigmaY = normalize( dFdy( surf_pos.xyz ) );
		vec3 vN = surf_norm;
		vec3 R1 = cross( vSigmaY, vN );
		vec3 R2 = cross( vN, vSigmaX );
		float fDet = dot( vSigmaX, R1 ) * faceDirection;
		vec3 vGrad = sign( fDet ) * ( dHdxy.x * R1 + dHdxy.y * R2 );
		return normalize( abs( fDet ) * surf_norm - vGrad );
	}
#endif`,tx=`#if NUM_CLIPPING_PLANES > 0
	vec4 plane;
	#ifdef ALPHA_TO_COVERAGE
		float distanceToPlane, distanceGradient;
		float clipOpacity = 1.0;
		#pragma unroll_loop_start
		for ( int i = 0; i < UNION_CLIPPING_PLANES; i ++ ) {
			plane = clippingPlanes[ i ];
			distanceToPlane = - dot( vClipPosition, plane.xyz ) + plane.w;
			distanceGradient = fwidth( distanceToPlane ) / 2.0;
			clipOpacity *= smoothstep( - distanceGradient, distanceGradient, distanceToPlane );
			if ( clipOpacity == 0.0 ) discard;
		}
		#pragma unroll_loop_end
		#if UNION_CLIPPING_PLANES < NUM_CLIPPING_PLANES
			float unionClipOpacity = 1.0;
			#pragma unroll_loop_start
			for ( int i = UNION_CLIPPING_PLANES; i < NUM_CLIPPING_PLANES; i ++ ) {
				plane = clippingPlanes[ i ];
				distanceToPlane = - dot( vClipPosition, plane.xyz ) + plane.w;
				distanceGradient = fwidth( distanceToPlane ) / 2.0;
				unionClipOpacity *= 1.0 - smoothstep( - distanceGradient, distanceGradient, distanceToPlane );
			}
			#pragma unroll_loop_end
			clipOpacity *= 1.0 - unionClipOpacity;
		#endif
		diffuseColor.a *= clipOpacity;
		if ( diffuseColor.a == 0.0 ) discard;
	#else
		#pragma unroll_loop_start
		for ( int i = 0; i < UNION_CLIPPING_PLANES; i ++ ) {
			plane = clippingPlanes[ i ];
			if ( dot( vClipPosition, plane.xyz ) > plane.w ) discard;
		}
		#pragma unroll_loop_end
		#if UNION_CLIPPING_PLANES < NUM_CLIPPING_PLANES
			bool clipped = true;
			#pragma unroll_loop_start
			for ( int i = UNION_CLIPPING_PLANES; i < NUM_CLIPPING_PLANES; i ++ ) {
				plane = clippingPlanes[ i ];
				clipped = ( dot( vClipPosition, plane.xyz ) > plane.w ) && clipped;
			}
			#pragma unroll_loop_end
			if ( clipped ) discard;
		#endif
	#endif
#endif`,ex=`#if NUM_CLIPPING_PLANES > 0
	varying vec3 vClipPosition;
	uniform vec4 clippingPlanes[ NUM_CLIPPING_PLANES ];
#endif`,nx=`#if NUM_CLIPPING_PLANES > 0
	varying vec3 vClipPosition;
#endif`,ix=`#if NUM_CLIPPING_PLANES > 0
	vClipPosition = - mvPosition.xyz;
#endif`,sx=`#if defined( USE_COLOR ) || defined( USE_COLOR_ALPHA )
	diffuseColor *= vColor;
#endif`,rx=`#if defined( USE_COLOR ) || defined( USE_COLOR_ALPHA )
	varying vec4 vColor;
#endif`,ox=`#if defined( USE_COLOR ) || defined( USE_COLOR_ALPHA ) || defined( USE_INSTANCING_COLOR ) || defined( USE_BATCHING_COLOR )
	varying vec4 vColor;
#endif`,ax=`#if defined( USE_COLOR ) || defined( USE_COLOR_ALPHA ) || defined( USE_INSTANCING_COLOR ) || defined( USE_BATCHING_COLOR )
	vColor = vec4( 1.0 );
#endif
#ifdef USE_COLOR_ALPHA
	vColor *= color;
#elif defined( USE_COLOR )
	vColor.rgb *= color;
#endif
#ifdef USE_INSTANCING_COLOR
	vColor.rgb *= instanceColor.rgb;
#endif
#ifdef USE_BATCHING_COLOR
	vColor *= getBatchingColor( getIndirectIndex( gl_DrawID ) );
#endif`,lx=`#define PI 3.141592653589793
#define PI2 6.283185307179586
#define PI_HALF 1.5707963267948966
#define RECIPROCAL_PI 0.3183098861837907
#define RECIPROCAL_PI2 0.15915494309189535
#define EPSILON 1e-6
#ifndef saturate
#define saturate( a ) clamp( a, 0.0, 1.0 )
#endif
#define whiteComplement( a ) ( 1.0 - saturate( a ) )
float pow2( const in float x ) { return x*x; }
vec3 pow2( const in vec3 x ) { return x*x; }
float pow3( const in float x ) { return x*x*x; }
float pow4( const in float x ) { float x2 = x*x; return x2*x2; }
float max3( const in vec3 v ) { return max( max( v.x, v.y ), v.z ); }
float average( const in vec3 v ) { return dot( v, vec3( 0.3333333 ) ); }
highp float rand( const in vec2 uv ) {
	const highp float a = 12.9898, b = 78.233, c = 43758.5453;
	highp float dt = dot( uv.xy, vec2( a,b ) ), sn = mod( dt, PI );
	return fract( sin( sn ) * c );
}
#ifdef HIGH_PRECISION
	float precisionSafeLength( vec3 v ) { return length( v ); }
#else
	float precisionSafeLength( vec3 v ) {
		float maxComponent = max3( abs( v ) );
		return length( v / maxComponent ) * maxComponent;
	}
#endif
struct IncidentLight {
	vec3 color;
	vec3 direction;
	bool visible;
};
struct ReflectedLight {
	vec3 directDiffuse;
	vec3 directSpecular;
	vec3 indirectDiffuse;
	vec3 indirectSpecular;
};
#ifdef USE_ALPHAHASH
	varying vec3 vPosition;
#endif
vec3 transformDirection( in vec3 dir, in mat4 matrix ) {
	return normalize( ( matrix * vec4( dir, 0.0 ) ).xyz );
}
#define inverseTransformDirection transformDirectionByInverseViewMatrix
vec3 transformNormalByInverseViewMatrix( in vec3 normal, in mat4 viewMatrix ) {
	return normalize( ( vec4( normal, 0.0 ) * viewMatrix ).xyz );
}
vec3 transformDirectionByInverseViewMatrix( in vec3 dir, in mat4 viewMatrix ) {
	return normalize( ( vec4( dir, 0.0 ) * viewMatrix ).xyz );
}
bool isPerspectiveMatrix( mat4 m ) {
	return m[ 2 ][ 3 ] == - 1.0;
}
vec2 equirectUv( in vec3 dir ) {
	float u = atan( dir.z, dir.x ) * RECIPROCAL_PI2 + 0.5;
	float v = asin( clamp( dir.y, - 1.0, 1.0 ) ) * RECIPROCAL_PI + 0.5;
	return vec2( u, v );
}
vec3 BRDF_Lambert( const in vec3 diffuseColor ) {
	return RECIPROCAL_PI * diffuseColor;
}
vec3 F_Schlick( const in vec3 f0, const in float f90, const in float dotVH ) {
	float fresnel = exp2( ( - 5.55473 * dotVH - 6.98316 ) * dotVH );
	return f0 * ( 1.0 - fresnel ) + ( f90 * fresnel );
}
float F_Schlick( const in float f0, const in float f90, const in float dotVH ) {
	float fresnel = exp2( ( - 5.55473 * dotVH - 6.98316 ) * dotVH );
	return f0 * ( 1.0 - fresnel ) + ( f90 * fresnel );
} // validated`,cx=`vec3 transformedNormal = objectNormal;
#ifdef USE_TANGENT
	vec3 transformedTangent = objectTangent;
#endif
#ifdef USE_BATCHING
	mat3 bm = mat3( batchingMatrix );
	transformedNormal /= vec3( dot( bm[ 0 ], bm[ 0 ] ), dot( bm[ 1 ], bm[ 1 ] ), dot( bm[ 2 ], bm[ 2 ] ) );
	transformedNormal = bm * transformedNormal;
	#ifdef USE_TANGENT
		transformedTangent = bm * transformedTangent;
	#endif
#endif
#ifdef USE_INSTANCING
	mat3 im = mat3( instanceMatrix );
	transformedNormal /= vec3( dot( im[ 0 ], im[ 0 ] ), dot( im[ 1 ], im[ 1 ] ), dot( im[ 2 ], im[ 2 ] ) );
	transformedNormal = im * transformedNormal;
	#ifdef USE_TANGENT
		transformedTangent = im * transformedTangent;
	#endif
#endif
transformedNormal = normalMatrix * transformedNormal;
#ifdef FLIP_SIDED
	transformedNormal = - transformedNormal;
#endif
#ifdef USE_TANGENT
	transformedTangent = ( modelViewMatrix * vec4( transformedTangent, 0.0 ) ).xyz;
#endif`,hx=`#ifdef USE_DISPLACEMENTMAP
	uniform sampler2D displacementMap;
	uniform float displacementScale;
	uniform float displacementBias;
#endif`,ux=`#ifdef USE_DISPLACEMENTMAP
	transformed += normalize( objectNormal ) * ( texture2D( displacementMap, vDisplacementMapUv ).x * displacementScale + displacementBias );
#endif`,dx=`#ifdef USE_EMISSIVEMAP
	vec4 emissiveColor = texture2D( emissiveMap, vEmissiveMapUv );
	#ifdef DECODE_VIDEO_TEXTURE_EMISSIVE
		emissiveColor = sRGBTransferEOTF( emissiveColor );
	#endif
	totalEmissiveRadiance *= emissiveColor.rgb;
#endif`,fx=`#ifdef USE_EMISSIVEMAP
	uniform sampler2D emissiveMap;
#endif`,px="gl_FragColor = linearToOutputTexel( gl_FragColor );",mx=`vec4 LinearTransferOETF( in vec4 value ) {
	return value;
}
vec4 sRGBTransferEOTF( in vec4 value ) {
	return vec4( mix( pow( value.rgb * 0.9478672986 + vec3( 0.0521327014 ), vec3( 2.4 ) ), value.rgb * 0.0773993808, vec3( lessThanEqual( value.rgb, vec3( 0.04045 ) ) ) ), value.a );
}
vec4 sRGBTransferOETF( in vec4 value ) {
	return vec4( mix( pow( value.rgb, vec3( 0.41666 ) ) * 1.055 - vec3( 0.055 ), value.rgb * 12.92, vec3( lessThanEqual( value.rgb, vec3( 0.0031308 ) ) ) ), value.a );
}`,gx=`#ifdef USE_ENVMAP
	#ifdef ENV_WORLDPOS
		vec3 cameraToFrag;
		if ( isOrthographic ) {
			cameraToFrag = normalize( vec3( - viewMatrix[ 0 ][ 2 ], - viewMatrix[ 1 ][ 2 ], - viewMatrix[ 2 ][ 2 ] ) );
		} else {
			cameraToFrag = normalize( vWorldPosition - cameraPosition );
		}
		vec3 worldNormal = transformNormalByInverseViewMatrix( normal, viewMatrix );
		#ifdef ENVMAP_MODE_REFLECTION
			vec3 reflectVec = reflect( cameraToFrag, worldNormal );
		#else
			vec3 reflectVec = refract( cameraToFrag, worldNormal, refractionRatio );
		#endif
	#else
		vec3 reflectVec = vReflect;
	#endif
	#ifdef ENVMAP_TYPE_CUBE
		vec4 envColor = textureCube( envMap, envMapRotation * reflectVec );
		#ifdef ENVMAP_BLENDING_MULTIPLY
			outgoingLight = mix( outgoingLight, outgoingLight * envColor.xyz, specularStrength * reflectivity );
		#elif defined( ENVMAP_BLENDING_MIX )
			outgoingLight = mix( outgoingLight, envColor.xyz, specularStrength * reflectivity );
		#elif defined( ENVMAP_BLENDING_ADD )
			outgoingLight += envColor.xyz * specularStrength * reflectivity;
		#endif
	#endif
#endif`,_x=`#ifdef USE_ENVMAP
	uniform float envMapIntensity;
	uniform mat3 envMapRotation;
	uniform samplerCube envMap;
	#ifdef ENVMAP_TYPE_PMREM
		float roughnessToMip( const in float roughness ) {
			float r = clamp( roughness, 0.0, 1.0 );
			return ENVMAP_MAX_LOD * r * ( 2.0 - r );
		}
	#endif
#endif`,xx=`#ifdef USE_ENVMAP
	uniform float reflectivity;
	#if defined( USE_BUMPMAP ) || defined( USE_NORMALMAP ) || defined( PHONG ) || defined( LAMBERT )
		#define ENV_WORLDPOS
	#endif
	#ifdef ENV_WORLDPOS
		varying vec3 vWorldPosition;
		uniform float refractionRatio;
	#else
		varying vec3 vReflect;
	#endif
#endif`,vx=`#ifdef USE_ENVMAP
	#if defined( USE_BUMPMAP ) || defined( USE_NORMALMAP ) || defined( PHONG ) || defined( LAMBERT )
		#define ENV_WORLDPOS
	#endif
	#ifdef ENV_WORLDPOS
		
		varying vec3 vWorldPosition;
	#else
		varying vec3 vReflect;
		uniform float refractionRatio;
	#endif
#endif`,yx=`#ifdef USE_ENVMAP
	#ifdef ENV_WORLDPOS
		vWorldPosition = worldPosition.xyz;
	#else
		vec3 cameraToVertex;
		if ( isOrthographic ) {
			cameraToVertex = normalize( vec3( - viewMatrix[ 0 ][ 2 ], - viewMatrix[ 1 ][ 2 ], - viewMatrix[ 2 ][ 2 ] ) );
		} else {
			cameraToVertex = normalize( worldPosition.xyz - cameraPosition );
		}
		vec3 worldNormal = transformNormalByInverseViewMatrix( transformedNormal, viewMatrix );
		#ifdef ENVMAP_MODE_REFLECTION
			vReflect = reflect( cameraToVertex, worldNormal );
		#else
			vReflect = refract( cameraToVertex, worldNormal, refractionRatio );
		#endif
	#endif
#endif`,bx=`#ifdef USE_FOG
	vFogDepth = - mvPosition.z;
#endif`,Mx=`#ifdef USE_FOG
	varying float vFogDepth;
#endif`,Sx=`#ifdef USE_FOG
	#ifdef FOG_EXP2
		float fogFactor = 1.0 - exp( - fogDensity * fogDensity * vFogDepth * vFogDepth );
	#else
		float fogFactor = smoothstep( fogNear, fogFar, vFogDepth );
	#endif
	gl_FragColor.rgb = mix( gl_FragColor.rgb, fogColor, fogFactor );
#endif`,wx=`#ifdef USE_FOG
	uniform vec3 fogColor;
	varying float vFogDepth;
	#ifdef FOG_EXP2
		uniform float fogDensity;
	#else
		uniform float fogNear;
		uniform float fogFar;
	#endif
#endif`,Ex=`#ifdef USE_GRADIENTMAP
	uniform sampler2D gradientMap;
#endif
vec3 getGradientIrradiance( vec3 normal, vec3 lightDirection ) {
	float dotNL = dot( normal, lightDirection );
	vec2 coord = vec2( dotNL * 0.5 + 0.5, 0.0 );
	#ifdef USE_GRADIENTMAP
		return vec3( texture2D( gradientMap, coord ).r );
	#else
		vec2 fw = fwidth( coord ) * 0.5;
		return mix( vec3( 0.7 ), vec3( 1.0 ), smoothstep( 0.7 - fw.x, 0.7 + fw.x, coord.x ) );
	#endif
}`,Ax=`#ifdef USE_LIGHTMAP
	uniform sampler2D lightMap;
	uniform float lightMapIntensity;
#endif`,Tx=`LambertMaterial material;
material.diffuseColor = diffuseColor.rgb;
material.specularStrength = specularStrength;`,Cx=`varying vec3 vViewPosition;
struct LambertMaterial {
	vec3 diffuseColor;
	float specularStrength;
};
void RE_Direct_Lambert( const in IncidentLight directLight, const in vec3 geometryPosition, const in vec3 geometryNormal, const in vec3 geometryViewDir, const in vec3 geometryClearcoatNormal, const in LambertMaterial material, inout ReflectedLight reflectedLight ) {
	float dotNL = saturate( dot( geometryNormal, directLight.direction ) );
	vec3 irradiance = dotNL * directLight.color;
	reflectedLight.directDiffuse += irradiance * BRDF_Lambert( material.diffuseColor );
}
void RE_IndirectDiffuse_Lambert( const in vec3 irradiance, const in vec3 geometryPosition, const in vec3 geometryNormal, const in vec3 geometryViewDir, const in vec3 geometryClearcoatNormal, const in LambertMaterial material, inout ReflectedLight reflectedLight ) {
	reflectedLight.indirectDiffuse += irradiance * BRDF_Lambert( material.diffuseColor );
}
#define RE_Direct				RE_Direct_Lambert
#define RE_IndirectDiffuse		RE_IndirectDiffuse_Lambert`,Rx=`uniform bool receiveShadow;
uniform vec3 ambientLightColor;
#if defined( USE_LIGHT_PROBES )
	uniform vec3 lightProbe[ 9 ];
#endif
vec3 shGetIrradianceAt( in vec3 normal, in vec3 shCoefficients[ 9 ] ) {
	float x = normal.x, y = normal.y, z = normal.z;
	vec3 result = shCoefficients[ 0 ] * 0.886227;
	result += shCoefficients[ 1 ] * 2.0 * 0.511664 * y;
	result += shCoefficients[ 2 ] * 2.0 * 0.511664 * z;
	result += shCoefficients[ 3 ] * 2.0 * 0.511664 * x;
	result += shCoefficients[ 4 ] * 2.0 * 0.429043 * x * y;
	result += shCoefficients[ 5 ] * 2.0 * 0.429043 * y * z;
	result += shCoefficients[ 6 ] * ( 0.743125 * z * z - 0.247708 );
	result += shCoefficients[ 7 ] * 2.0 * 0.429043 * x * z;
	result += shCoefficients[ 8 ] * 0.429043 * ( x * x - y * y );
	return result;
}
vec3 getLightProbeIrradiance( const in vec3 lightProbe[ 9 ], const in vec3 normal ) {
	vec3 worldNormal = transformNormalByInverseViewMatrix( normal, viewMatrix );
	vec3 irradiance = shGetIrradianceAt( worldNormal, lightProbe );
	return irradiance;
}
vec3 getAmbientLightIrradiance( const in vec3 ambientLightColor ) {
	vec3 irradiance = ambientLightColor;
	return irradiance;
}
float getDistanceAttenuation( const in float lightDistance, const in float cutoffDistance, const in float decayExponent ) {
	float distanceFalloff = 1.0 / max( pow( lightDistance, decayExponent ), 0.01 );
	if ( cutoffDistance > 0.0 ) {
		distanceFalloff *= pow2( saturate( 1.0 - pow4( lightDistance / cutoffDistance ) ) );
	}
	return distanceFalloff;
}
float getSpotAttenuation( const in float coneCosine, const in float penumbraCosine, const in float angleCosine ) {
	return smoothstep( coneCosine, penumbraCosine, angleCosine );
}
#if NUM_SUN_LIGHTS > 0
	struct SunLight {
		vec3 direction;
		vec3 color;
	};
	uniform SunLight sunLights[ NUM_SUN_LIGHTS ];
	void getSunLightInfo( const in SunLight sunLight, out IncidentLight light ) {
		light.color = sunLight.color;
		light.direction = sunLight.direction;
		light.visible = true;
	}
#endif
#if NUM_DIR_LIGHTS > 0
	struct DirectionalLight {
		vec3 direction;
		vec3 color;
	};
	uniform DirectionalLight directionalLights[ NUM_DIR_LIGHTS ];
	void getDirectionalLightInfo( const in DirectionalLight directionalLight, out IncidentLight light ) {
		light.color = directionalLight.color;
		light.direction = directionalLight.direction;
		light.visible = true;
	}
#endif
#if NUM_POINT_LIGHTS > 0
	struct PointLight {
		vec3 position;
		vec3 color;
		float distance;
		float decay;
	};
	uniform PointLight pointLights[ NUM_POINT_LIGHTS ];
	void getPointLightInfo( const in PointLight pointLight, const in vec3 geometryPosition, out IncidentLight light ) {
		vec3 lVector = pointLight.position - geometryPosition;
		light.direction = normalize( lVector );
		float lightDistance = length( lVector );
		light.color = pointLight.color;
		light.color *= getDistanceAttenuation( lightDistance, pointLight.distance, pointLight.decay );
		light.visible = ( light.color != vec3( 0.0 ) );
	}
#endif
#if NUM_SPOT_LIGHTS > 0
	struct SpotLight {
		vec3 position;
		vec3 direction;
		vec3 color;
		float distance;
		float decay;
		float coneCos;
		float penumbraCos;
	};
	uniform SpotLight spotLights[ NUM_SPOT_LIGHTS ];
	void getSpotLightInfo( const in SpotLight spotLight, const in vec3 geometryPosition, out IncidentLight light ) {
		vec3 lVector = spotLight.position - geometryPosition;
		light.direction = normalize( lVector );
		float angleCos = dot( light.direction, spotLight.direction );
		float spotAttenuation = getSpotAttenuation( spotLight.coneCos, spotLight.penumbraCos, angleCos );
		if ( spotAttenuation > 0.0 ) {
			float lightDistance = length( lVector );
			light.color = spotLight.color * spotAttenuation;
			light.color *= getDistanceAttenuation( lightDistance, spotLight.distance, spotLight.decay );
			light.visible = ( light.color != vec3( 0.0 ) );
		} else {
			light.color = vec3( 0.0 );
			light.visible = false;
		}
	}
#endif
#if NUM_RECT_AREA_LIGHTS > 0
	struct RectAreaLight {
		vec3 color;
		vec3 position;
		vec3 halfWidth;
		vec3 halfHeight;
	};
	uniform sampler2D ltc_1;	uniform sampler2D ltc_2;
	uniform RectAreaLight rectAreaLights[ NUM_RECT_AREA_LIGHTS ];
#endif
#if NUM_HEMI_LIGHTS > 0
	struct HemisphereLight {
		vec3 direction;
		vec3 skyColor;
		vec3 groundColor;
	};
	uniform HemisphereLight hemisphereLights[ NUM_HEMI_LIGHTS ];
	vec3 getHemisphereLightIrradiance( const in HemisphereLight hemiLight, const in vec3 normal ) {
		float dotNL = dot( normal, hemiLight.direction );
		float hemiDiffuseWeight = 0.5 * dotNL + 0.5;
		vec3 irradiance = mix( hemiLight.groundColor, hemiLight.skyColor, hemiDiffuseWeight );
		return irradiance;
	}
#endif
#include <lightprobes_pars_fragment>`,Px=`#ifdef USE_ENVMAP
	vec3 getIBLIrradiance( const in vec3 normal ) {
		#ifdef ENVMAP_TYPE_PMREM
			vec3 worldNormal = transformNormalByInverseViewMatrix( normal, viewMatrix );
			vec4 envMapColor = textureLod( envMap, envMapRotation * worldNormal, ENVMAP_MAX_LOD );
			return PI * envMapColor.rgb * envMapIntensity;
		#else
			return vec3( 0.0 );
		#endif
	}
	vec3 getIBLRadiance( const in vec3 viewDir, const in vec3 normal, const in float roughness ) {
		#ifdef ENVMAP_TYPE_PMREM
			vec3 reflectVec = reflect( - viewDir, normal );
			reflectVec = normalize( mix( reflectVec, normal, pow4( roughness ) ) );
			reflectVec = transformDirectionByInverseViewMatrix( reflectVec, viewMatrix );
			vec4 envMapColor = textureLod( envMap, envMapRotation * reflectVec, roughnessToMip( roughness ) );
			return envMapColor.rgb * envMapIntensity;
		#else
			return vec3( 0.0 );
		#endif
	}
	#ifdef USE_RETROREFLECTION
		vec3 getIBLRetroRadiance( const in vec3 viewDir, const in vec3 normal, const in float roughness ) {
			#ifdef ENVMAP_TYPE_PMREM
				vec3 retroVec = normalize( mix( viewDir, normal, pow4( roughness ) ) );
				retroVec = transformDirectionByInverseViewMatrix( retroVec, viewMatrix );
				vec4 envMapColor = textureLod( envMap, envMapRotation * retroVec, roughnessToMip( roughness ) );
				return envMapColor.rgb * envMapIntensity;
			#else
				return vec3( 0.0 );
			#endif
		}
	#endif
	#ifdef USE_ANISOTROPY
		vec3 getIBLAnisotropyRadiance( const in vec3 viewDir, const in vec3 normal, const in float roughness, const in vec3 bitangent, const in float anisotropy ) {
			#ifdef ENVMAP_TYPE_PMREM
				vec3 bentNormal = cross( bitangent, viewDir );
				bentNormal = normalize( cross( bentNormal, bitangent ) );
				bentNormal = normalize( mix( bentNormal, normal, pow2( pow2( 1.0 - anisotropy * ( 1.0 - roughness ) ) ) ) );
				return getIBLRadiance( viewDir, bentNormal, roughness );
			#else
				return vec3( 0.0 );
			#endif
		}
		#ifdef USE_RETROREFLECTION
			vec3 getIBLAnisotropyRetroRadiance( const in vec3 viewDir, const in vec3 normal, const in float roughness, const in vec3 bitangent, const in float anisotropy ) {
				#ifdef ENVMAP_TYPE_PMREM
					vec3 bentNormal = cross( bitangent, viewDir );
					bentNormal = normalize( cross( bentNormal, bitangent ) );
					bentNormal = normalize( mix( bentNormal, normal, pow2( pow2( 1.0 - anisotropy * ( 1.0 - roughness ) ) ) ) );
					return getIBLRetroRadiance( viewDir, bentNormal, roughness );
				#else
					return vec3( 0.0 );
				#endif
			}
		#endif
	#endif
#endif`,Ix=`ToonMaterial material;
material.diffuseColor = diffuseColor.rgb;`,Lx=`varying vec3 vViewPosition;
struct ToonMaterial {
	vec3 diffuseColor;
};
void RE_Direct_Toon( const in IncidentLight directLight, const in vec3 geometryPosition, const in vec3 geometryNormal, const in vec3 geometryViewDir, const in vec3 geometryClearcoatNormal, const in ToonMaterial material, inout ReflectedLight reflectedLight ) {
	vec3 irradiance = getGradientIrradiance( geometryNormal, directLight.direction ) * directLight.color;
	reflectedLight.directDiffuse += irradiance * BRDF_Lambert( material.diffuseColor );
}
void RE_IndirectDiffuse_Toon( const in vec3 irradiance, const in vec3 geometryPosition, const in vec3 geometryNormal, const in vec3 geometryViewDir, const in vec3 geometryClearcoatNormal, const in ToonMaterial material, inout ReflectedLight reflectedLight ) {
	reflectedLight.indirectDiffuse += irradiance * BRDF_Lambert( material.diffuseColor );
}
#define RE_Direct				RE_Direct_Toon
#define RE_IndirectDiffuse		RE_IndirectDiffuse_Toon`,Dx=`BlinnPhongMaterial material;
material.diffuseColor = diffuseColor.rgb;
material.specularColor = specular;
material.specularShininess = shininess;
material.specularStrength = specularStrength;`,Nx=`varying vec3 vViewPosition;
struct BlinnPhongMaterial {
	vec3 diffuseColor;
	vec3 specularColor;
	float specularShininess;
	float specularStrength;
};
void RE_Direct_BlinnPhong( const in IncidentLight directLight, const in vec3 geometryPosition, const in vec3 geometryNormal, const in vec3 geometryViewDir, const in vec3 geometryClearcoatNormal, const in BlinnPhongMaterial material, inout ReflectedLight reflectedLight ) {
	float dotNL = saturate( dot( geometryNormal, directLight.direction ) );
	vec3 irradiance = dotNL * directLight.color;
	reflectedLight.directDiffuse += irradiance * BRDF_Lambert( material.diffuseColor );
	reflectedLight.directSpecular += irradiance * BRDF_BlinnPhong( directLight.direction, geometryViewDir, geometryNormal, material.specularColor, material.specularShininess ) * material.specularStrength;
}
void RE_IndirectDiffuse_BlinnPhong( const in vec3 irradiance, const in vec3 geometryPosition, const in vec3 geometryNormal, const in vec3 geometryViewDir, const in vec3 geometryClearcoatNormal, const in BlinnPhongMaterial material, inout ReflectedLight reflectedLight ) {
	reflectedLight.indirectDiffuse += irradiance * BRDF_Lambert( material.diffuseColor );
}
#define RE_Direct				RE_Direct_BlinnPhong
#define RE_IndirectDiffuse		RE_IndirectDiffuse_BlinnPhong`,Ux=`PhysicalMaterial material;
material.diffuseColor = diffuseColor.rgb;
material.diffuseContribution = diffuseColor.rgb * ( 1.0 - metalnessFactor );
material.metalness = metalnessFactor;
vec3 dxy = max( abs( dFdx( nonPerturbedNormal ) ), abs( dFdy( nonPerturbedNormal ) ) );
float geometryRoughness = max( max( dxy.x, dxy.y ), dxy.z );
material.roughness = max( roughnessFactor, 0.045 );
material.roughness += geometryRoughness;
material.roughness = min( material.roughness, 1.0 );
#ifdef USE_DIFFUSE_ROUGHNESS
	float diffuseRoughnessFactor = diffuseRoughness;
	#ifdef USE_DIFFUSE_ROUGHNESSMAP
		diffuseRoughnessFactor *= texture2D( diffuseRoughnessMap, vDiffuseRoughnessMapUv ).r;
	#endif
	material.diffuseRoughness = saturate( diffuseRoughnessFactor );
#endif
#ifdef IOR
	material.ior = ior;
	#ifdef USE_SPECULAR
		float specularIntensityFactor = specularIntensity;
		vec3 specularColorFactor = specularColor;
		#ifdef USE_SPECULAR_COLORMAP
			specularColorFactor *= texture2D( specularColorMap, vSpecularColorMapUv ).rgb;
		#endif
		#ifdef USE_SPECULAR_INTENSITYMAP
			specularIntensityFactor *= texture2D( specularIntensityMap, vSpecularIntensityMapUv ).a;
		#endif
		material.specularF90 = mix( specularIntensityFactor, 1.0, metalnessFactor );
	#else
		float specularIntensityFactor = 1.0;
		vec3 specularColorFactor = vec3( 1.0 );
		material.specularF90 = 1.0;
	#endif
	material.specularColor = min( pow2( ( material.ior - 1.0 ) / ( material.ior + 1.0 ) ) * specularColorFactor, vec3( 1.0 ) ) * specularIntensityFactor;
	material.specularColorBlended = mix( material.specularColor, diffuseColor.rgb, metalnessFactor );
#else
	material.specularColor = vec3( 0.04 );
	material.specularColorBlended = mix( material.specularColor, diffuseColor.rgb, metalnessFactor );
	material.specularF90 = 1.0;
#endif
#ifdef USE_CLEARCOAT
	material.clearcoat = clearcoat;
	material.clearcoatRoughness = clearcoatRoughness;
	material.clearcoatF0 = vec3( 0.04 );
	material.clearcoatF90 = 1.0;
	#ifdef USE_CLEARCOATMAP
		material.clearcoat *= texture2D( clearcoatMap, vClearcoatMapUv ).x;
	#endif
	#ifdef USE_CLEARCOAT_ROUGHNESSMAP
		material.clearcoatRoughness *= texture2D( clearcoatRoughnessMap, vClearcoatRoughnessMapUv ).y;
	#endif
	material.clearcoat = saturate( material.clearcoat );	material.clearcoatRoughness = max( material.clearcoatRoughness, 0.045 );
	material.clearcoatRoughness += geometryRoughness;
	material.clearcoatRoughness = min( material.clearcoatRoughness, 1.0 );
#endif
#ifdef USE_DISPERSION
	material.dispersion = dispersion;
#endif
#ifdef USE_RETROREFLECTION
	material.retroreflectivity = retroreflectivity;
#endif
#ifdef USE_IRIDESCENCE
	material.iridescence = iridescence;
	material.iridescenceIOR = iridescenceIOR;
	#ifdef USE_IRIDESCENCEMAP
		material.iridescence *= texture2D( iridescenceMap, vIridescenceMapUv ).r;
	#endif
	#ifdef USE_IRIDESCENCE_THICKNESSMAP
		material.iridescenceThickness = (iridescenceThicknessMaximum - iridescenceThicknessMinimum) * texture2D( iridescenceThicknessMap, vIridescenceThicknessMapUv ).g + iridescenceThicknessMinimum;
	#else
		material.iridescenceThickness = iridescenceThicknessMaximum;
	#endif
#endif
#ifdef USE_SHEEN
	material.sheenColor = sheenColor;
	#ifdef USE_SHEEN_COLORMAP
		material.sheenColor *= texture2D( sheenColorMap, vSheenColorMapUv ).rgb;
	#endif
	material.sheenRoughness = clamp( sheenRoughness, 0.0001, 1.0 );
	#ifdef USE_SHEEN_ROUGHNESSMAP
		material.sheenRoughness *= texture2D( sheenRoughnessMap, vSheenRoughnessMapUv ).a;
	#endif
#endif
#ifdef USE_ANISOTROPY
	#ifdef USE_ANISOTROPYMAP
		mat2 anisotropyMat = mat2( anisotropyVector.x, anisotropyVector.y, - anisotropyVector.y, anisotropyVector.x );
		vec3 anisotropyPolar = texture2D( anisotropyMap, vAnisotropyMapUv ).rgb;
		vec2 anisotropyV = anisotropyMat * normalize( 2.0 * anisotropyPolar.rg - vec2( 1.0 ) ) * anisotropyPolar.b;
	#else
		vec2 anisotropyV = anisotropyVector;
	#endif
	material.anisotropy = length( anisotropyV );
	if( material.anisotropy == 0.0 ) {
		anisotropyV = vec2( 1.0, 0.0 );
	} else {
		anisotropyV /= material.anisotropy;
		material.anisotropy = saturate( material.anisotropy );
	}
	material.alphaT = mix( pow2( material.roughness ), 1.0, pow2( material.anisotropy ) );
	material.anisotropyT = tbn[ 0 ] * anisotropyV.x + tbn[ 1 ] * anisotropyV.y;
	material.anisotropyB = tbn[ 1 ] * anisotropyV.x - tbn[ 0 ] * anisotropyV.y;
#endif`,Ox=`uniform sampler2D dfgLUT;
struct PhysicalMaterial {
	vec3 diffuseColor;
	vec3 diffuseContribution;
	vec3 specularColor;
	vec3 specularColorBlended;
	float roughness;
	float metalness;
	float specularF90;
	float dispersion;
	vec2 dfg;
	vec3 multiScatteringCompensation;
	#ifdef USE_DIFFUSE_ROUGHNESS
		float diffuseRoughness;
	#endif
	#ifdef USE_RETROREFLECTION
		float retroreflectivity;
	#endif
	#ifdef USE_CLEARCOAT
		float clearcoat;
		float clearcoatRoughness;
		vec3 clearcoatF0;
		float clearcoatF90;
	#endif
	#ifdef USE_IRIDESCENCE
		float iridescence;
		float iridescenceIOR;
		float iridescenceThickness;
		vec3 iridescenceFresnel;
		vec3 iridescenceF0Dielectric;
		vec3 iridescenceF0Metallic;
	#endif
	#ifdef USE_SHEEN
		vec3 sheenColor;
		float sheenRoughness;
	#endif
	#ifdef IOR
		float ior;
	#endif
	#ifdef USE_TRANSMISSION
		float transmission;
		float transmissionAlpha;
		float thickness;
		float attenuationDistance;
		vec3 attenuationColor;
	#endif
	#ifdef USE_ANISOTROPY
		float anisotropy;
		float alphaT;
		vec3 anisotropyT;
		vec3 anisotropyB;
	#endif
};
vec3 clearcoatSpecularDirect = vec3( 0.0 );
vec3 clearcoatSpecularIndirect = vec3( 0.0 );
vec3 sheenSpecularDirect = vec3( 0.0 );
vec3 sheenSpecularIndirect = vec3(0.0 );
vec3 Schlick_to_F0( const in vec3 f, const in float f90, const in float dotVH ) {
    float x = clamp( 1.0 - dotVH, 0.0, 1.0 );
    float x2 = x * x;
    float x5 = clamp( x * x2 * x2, 0.0, 0.9999 );
    return ( f - vec3( f90 ) * x5 ) / ( 1.0 - x5 );
}
#ifdef USE_DIFFUSE_ROUGHNESS
	const float EON_EPSILON = 1e-7;
	float FON_DirectionalAlbedo( const in float mu, const in float roughness, const in float A ) {
		float muComp = 1.0 - mu;
		float gOverPi = muComp * ( 0.0571085289 + muComp * ( 0.491881867 + muComp * ( - 0.332181442 + muComp * 0.0714429953 ) ) );
		return A * ( 1.0 + roughness * gOverPi );
	}
	vec3 BRDF_EON( const in vec3 lightDir, const in vec3 viewDir, const in vec3 normal, const in vec3 diffuseColor, const in float roughness ) {
		vec3 rho = saturate( diffuseColor );
		if ( roughness <= EON_EPSILON ) return BRDF_Lambert( rho );
		float dotNL = saturate( dot( normal, lightDir ) );
		float dotNV = saturate( dot( normal, viewDir ) );
		float s = dot( lightDir, viewDir ) - dotNL * dotNV;
		float sOverT = ( s > 0.0 ) ? s / max( max( dotNL, dotNV ), EON_EPSILON ) : s;
		float A = 1.0 / ( 1.0 + ( 0.5 - 2.0 / ( 3.0 * PI ) ) * roughness );
		vec3 singleScatter = rho * RECIPROCAL_PI * A * ( 1.0 + roughness * sOverT );
		float averageAlbedo = A * ( 1.0 + ( 2.0 / 3.0 - 28.0 / ( 15.0 * PI ) ) * roughness );
		float albedoV = FON_DirectionalAlbedo( dotNV, roughness, A );
		float albedoL = FON_DirectionalAlbedo( dotNL, roughness, A );
		vec3 rhoMultiScatter = rho * rho * averageAlbedo / max( vec3( EON_EPSILON ), vec3( 1.0 ) - rho * ( 1.0 - averageAlbedo ) );
		vec3 multiScatter = rhoMultiScatter * RECIPROCAL_PI
			* max( EON_EPSILON, 1.0 - albedoV )
			* max( EON_EPSILON, 1.0 - albedoL )
			/ max( EON_EPSILON, 1.0 - averageAlbedo );
		return singleScatter + multiScatter;
	}
	vec3 EON_DirectionalAlbedo( const in vec3 diffuseColor, const in float roughness, const in float dotNV ) {
		vec3 rho = saturate( diffuseColor );
		if ( roughness <= EON_EPSILON ) return rho;
		float A = 1.0 / ( 1.0 + ( 0.5 - 2.0 / ( 3.0 * PI ) ) * roughness );
		float directionalAlbedo = FON_DirectionalAlbedo( dotNV, roughness, A );
		float averageAlbedo = A * ( 1.0 + ( 2.0 / 3.0 - 28.0 / ( 15.0 * PI ) ) * roughness );
		vec3 rhoMultiScatter = rho * rho * averageAlbedo / max( vec3( EON_EPSILON ), vec3( 1.0 ) - rho * ( 1.0 - averageAlbedo ) );
		return rho * directionalAlbedo + rhoMultiScatter * ( 1.0 - directionalAlbedo );
	}
#endif
float V_GGX_SmithCorrelated( const in float alpha, const in float dotNL, const in float dotNV ) {
	float a2 = pow2( alpha );
	float gv = dotNL * sqrt( a2 + ( 1.0 - a2 ) * pow2( dotNV ) );
	float gl = dotNV * sqrt( a2 + ( 1.0 - a2 ) * pow2( dotNL ) );
	return 0.5 / max( gv + gl, EPSILON );
}
float D_GGX( const in float alpha, const in float dotNH ) {
	float a2 = pow2( alpha );
	float denom = pow2( dotNH ) * ( a2 - 1.0 ) + 1.0;
	return RECIPROCAL_PI * a2 / pow2( denom );
}
#ifdef USE_ANISOTROPY
	float V_GGX_SmithCorrelated_Anisotropic( const in float alphaT, const in float alphaB, const in float dotTV, const in float dotBV, const in float dotTL, const in float dotBL, const in float dotNV, const in float dotNL ) {
		float gv = dotNL * length( vec3( alphaT * dotTV, alphaB * dotBV, dotNV ) );
		float gl = dotNV * length( vec3( alphaT * dotTL, alphaB * dotBL, dotNL ) );
		return 0.5 / max( gv + gl, EPSILON );
	}
	float D_GGX_Anisotropic( const in float alphaT, const in float alphaB, const in float dotNH, const in float dotTH, const in float dotBH ) {
		float a2 = alphaT * alphaB;
		highp vec3 v = vec3( alphaB * dotTH, alphaT * dotBH, a2 * dotNH );
		highp float v2 = dot( v, v );
		float w2 = a2 / v2;
		return RECIPROCAL_PI * a2 * pow2 ( w2 );
	}
#endif
#ifdef USE_CLEARCOAT
	vec3 BRDF_GGX_Clearcoat( const in vec3 lightDir, const in vec3 viewDir, const in vec3 normal, const in PhysicalMaterial material) {
		vec3 f0 = material.clearcoatF0;
		float f90 = material.clearcoatF90;
		float roughness = max( material.clearcoatRoughness, 0.045 );
		float alpha = pow2( roughness );
		vec3 halfDir = normalize( lightDir + viewDir );
		float dotNL = saturate( dot( normal, lightDir ) );
		float dotNV = saturate( dot( normal, viewDir ) );
		float dotNH = saturate( dot( normal, halfDir ) );
		float dotVH = saturate( dot( viewDir, halfDir ) );
		vec3 F = F_Schlick( f0, f90, dotVH );
		float V = V_GGX_SmithCorrelated( alpha, dotNL, dotNV );
		float D = D_GGX( alpha, dotNH );
		return F * ( V * D );
	}
#endif
vec3 BRDF_GGX( const in vec3 lightDir, const in vec3 viewDir, const in vec3 normal, const in PhysicalMaterial material ) {
	vec3 f0 = material.specularColorBlended;
	float f90 = material.specularF90;
	float roughness = max( material.roughness, 0.045 );
	float alpha = pow2( roughness );
	vec3 halfDir = normalize( lightDir + viewDir );
	float dotNL = saturate( dot( normal, lightDir ) );
	float dotNV = saturate( dot( normal, viewDir ) );
	float dotNH = saturate( dot( normal, halfDir ) );
	float dotVH = saturate( dot( viewDir, halfDir ) );
	vec3 F = F_Schlick( f0, f90, dotVH );
	#ifdef USE_IRIDESCENCE
		F = mix( F, material.iridescenceFresnel, material.iridescence );
	#endif
	#ifdef USE_ANISOTROPY
		float dotTL = dot( material.anisotropyT, lightDir );
		float dotTV = dot( material.anisotropyT, viewDir );
		float dotTH = dot( material.anisotropyT, halfDir );
		float dotBL = dot( material.anisotropyB, lightDir );
		float dotBV = dot( material.anisotropyB, viewDir );
		float dotBH = dot( material.anisotropyB, halfDir );
		float alphaT = max( material.alphaT, alpha );
		float V = V_GGX_SmithCorrelated_Anisotropic( alphaT, alpha, dotTV, dotBV, dotTL, dotBL, dotNV, dotNL );
		float D = D_GGX_Anisotropic( alphaT, alpha, dotNH, dotTH, dotBH );
	#else
		float V = V_GGX_SmithCorrelated( alpha, dotNL, dotNV );
		float D = D_GGX( alpha, dotNH );
	#endif
	return F * ( V * D );
}
vec2 LTC_Uv( const in vec3 N, const in vec3 V, const in float roughness ) {
	const float LUT_SIZE = 64.0;
	const float LUT_SCALE = ( LUT_SIZE - 1.0 ) / LUT_SIZE;
	const float LUT_BIAS = 0.5 / LUT_SIZE;
	float dotNV = saturate( dot( N, V ) );
	vec2 uv = vec2( roughness, sqrt( 1.0 - dotNV ) );
	uv = uv * LUT_SCALE + LUT_BIAS;
	return uv;
}
float LTC_ClippedSphereFormFactor( const in vec3 f ) {
	float l = length( f );
	return max( ( l * l + f.z ) / ( l + 1.0 ), 0.0 );
}
vec3 LTC_EdgeVectorFormFactor( const in vec3 v1, const in vec3 v2 ) {
	float x = dot( v1, v2 );
	float y = abs( x );
	float a = 0.8543985 + ( 0.4965155 + 0.0145206 * y ) * y;
	float b = 3.4175940 + ( 4.1616724 + y ) * y;
	float v = a / b;
	float theta_sintheta = ( x > 0.0 ) ? v : 0.5 * inversesqrt( max( 1.0 - x * x, 1e-7 ) ) - v;
	return cross( v1, v2 ) * theta_sintheta;
}
vec3 LTC_Evaluate( const in vec3 N, const in vec3 V, const in vec3 P, const in mat3 mInv, const in vec3 rectCoords[ 4 ] ) {
	vec3 v1 = rectCoords[ 1 ] - rectCoords[ 0 ];
	vec3 v2 = rectCoords[ 3 ] - rectCoords[ 0 ];
	vec3 lightNormal = cross( v1, v2 );
	if( dot( lightNormal, P - rectCoords[ 0 ] ) < 0.0 ) return vec3( 0.0 );
	vec3 T1, T2;
	T1 = normalize( V - N * dot( V, N ) );
	T2 = - cross( N, T1 );
	mat3 mat = mInv * transpose( mat3( T1, T2, N ) );
	vec3 coords[ 4 ];
	coords[ 0 ] = mat * ( rectCoords[ 0 ] - P );
	coords[ 1 ] = mat * ( rectCoords[ 1 ] - P );
	coords[ 2 ] = mat * ( rectCoords[ 2 ] - P );
	coords[ 3 ] = mat * ( rectCoords[ 3 ] - P );
	coords[ 0 ] = normalize( coords[ 0 ] );
	coords[ 1 ] = normalize( coords[ 1 ] );
	coords[ 2 ] = normalize( coords[ 2 ] );
	coords[ 3 ] = normalize( coords[ 3 ] );
	vec3 vectorFormFactor = vec3( 0.0 );
	vectorFormFactor += LTC_EdgeVectorFormFactor( coords[ 0 ], coords[ 1 ] );
	vectorFormFactor += LTC_EdgeVectorFormFactor( coords[ 1 ], coords[ 2 ] );
	vectorFormFactor += LTC_EdgeVectorFormFactor( coords[ 2 ], coords[ 3 ] );
	vectorFormFactor += LTC_EdgeVectorFormFactor( coords[ 3 ], coords[ 0 ] );
	float result = LTC_ClippedSphereFormFactor( vectorFormFactor );
	return vec3( result );
}
#if defined( USE_SHEEN )
float D_Charlie( float roughness, float dotNH ) {
	float alpha = pow2( roughness );
	float invAlpha = 1.0 / alpha;
	float cos2h = dotNH * dotNH;
	float sin2h = max( 1.0 - cos2h, 0.0078125 );
	return ( 2.0 + invAlpha ) * pow( sin2h, invAlpha * 0.5 ) / ( 2.0 * PI );
}
float V_Neubelt( float dotNV, float dotNL ) {
	return saturate( 1.0 / ( 4.0 * ( dotNL + dotNV - dotNL * dotNV ) ) );
}
vec3 BRDF_Sheen( const in vec3 lightDir, const in vec3 viewDir, const in vec3 normal, vec3 sheenColor, const in float sheenRoughness ) {
	vec3 halfDir = normalize( lightDir + viewDir );
	float dotNL = saturate( dot( normal, lightDir ) );
	float dotNV = saturate( dot( normal, viewDir ) );
	float dotNH = saturate( dot( normal, halfDir ) );
	float D = D_Charlie( sheenRoughness, dotNH );
	float V = V_Neubelt( dotNV, dotNL );
	return sheenColor * ( D * V );
}
#endif
float IBLSheenBRDF( const in vec3 normal, const in vec3 viewDir, const in float roughness ) {
	float dotNV = saturate( dot( normal, viewDir ) );
	float r2 = roughness * roughness;
	float rInv = 1.0 / ( roughness + 0.1 );
	float a = -1.9362 + 1.0678 * roughness + 0.4573 * r2 - 0.8469 * rInv;
	float b = -0.6014 + 0.5538 * roughness - 0.4670 * r2 - 0.1255 * rInv;
	float DG = exp( a * dotNV + b );
	return saturate( DG );
}
vec3 EnvironmentBRDF( const in vec3 normal, const in vec3 viewDir, const in vec3 specularColor, const in float specularF90, const in float roughness ) {
	float dotNV = saturate( dot( normal, viewDir ) );
	vec2 fab = texture2D( dfgLUT, vec2( roughness, dotNV ) ).rg;
	return specularColor * fab.x + specularF90 * fab.y;
}
#ifdef USE_IRIDESCENCE
void computeMultiscatteringIridescence( const in vec2 fab, const in vec3 specularColor, const in float specularF90, const in float iridescence, const in vec3 iridescenceF0, inout vec3 singleScatter, inout vec3 multiScatter ) {
#else
void computeMultiscattering( const in vec2 fab, const in vec3 specularColor, const in float specularF90, inout vec3 singleScatter, inout vec3 multiScatter ) {
#endif
	#ifdef USE_IRIDESCENCE
		vec3 Fr = mix( specularColor, iridescenceF0, iridescence );
	#else
		vec3 Fr = specularColor;
	#endif
	vec3 FssEss = Fr * fab.x + specularF90 * fab.y;
	float Ess = fab.x + fab.y;
	float Ems = 1.0 - Ess;
	vec3 Favg = Fr + ( 1.0 - Fr ) * 0.047619;	vec3 Fms = FssEss * Favg / ( 1.0 - Ems * Favg );
	singleScatter += FssEss;
	multiScatter += Fms * Ems;
}
#if NUM_RECT_AREA_LIGHTS > 0
	void RE_Direct_RectArea_Physical( const in RectAreaLight rectAreaLight, const in vec3 geometryPosition, const in vec3 geometryNormal, const in vec3 geometryViewDir, const in vec3 geometryClearcoatNormal, const in PhysicalMaterial material, inout ReflectedLight reflectedLight ) {
		vec3 normal = geometryNormal;
		vec3 viewDir = geometryViewDir;
		vec3 position = geometryPosition;
		vec3 lightPos = rectAreaLight.position;
		vec3 halfWidth = rectAreaLight.halfWidth;
		vec3 halfHeight = rectAreaLight.halfHeight;
		vec3 lightColor = rectAreaLight.color;
		float roughness = material.roughness;
		vec3 rectCoords[ 4 ];
		rectCoords[ 0 ] = lightPos + halfWidth - halfHeight;		rectCoords[ 1 ] = lightPos - halfWidth - halfHeight;
		rectCoords[ 2 ] = lightPos - halfWidth + halfHeight;
		rectCoords[ 3 ] = lightPos + halfWidth + halfHeight;
		vec2 uv = LTC_Uv( normal, viewDir, roughness );
		vec4 t1 = texture2D( ltc_1, uv );
		vec4 t2 = texture2D( ltc_2, uv );
		mat3 mInv = mat3(
			vec3( t1.x, 0, t1.y ),
			vec3(    0, 1,    0 ),
			vec3( t1.z, 0, t1.w )
		);
		vec3 fresnel = ( material.specularColorBlended * t2.x + ( material.specularF90 - material.specularColorBlended ) * t2.y );
		reflectedLight.directSpecular += lightColor * fresnel * LTC_Evaluate( normal, viewDir, position, mInv, rectCoords );
		reflectedLight.directDiffuse += lightColor * material.diffuseContribution * LTC_Evaluate( normal, viewDir, position, mat3( 1.0 ), rectCoords );
		#ifdef USE_CLEARCOAT
			vec3 Ncc = geometryClearcoatNormal;
			vec2 uvClearcoat = LTC_Uv( Ncc, viewDir, material.clearcoatRoughness );
			vec4 t1Clearcoat = texture2D( ltc_1, uvClearcoat );
			vec4 t2Clearcoat = texture2D( ltc_2, uvClearcoat );
			mat3 mInvClearcoat = mat3(
				vec3( t1Clearcoat.x, 0, t1Clearcoat.y ),
				vec3(             0, 1,             0 ),
				vec3( t1Clearcoat.z, 0, t1Clearcoat.w )
			);
			vec3 fresnelClearcoat = material.clearcoatF0 * t2Clearcoat.x + ( material.clearcoatF90 - material.clearcoatF0 ) * t2Clearcoat.y;
			clearcoatSpecularDirect += lightColor * fresnelClearcoat * LTC_Evaluate( Ncc, viewDir, position, mInvClearcoat, rectCoords );
		#endif
	}
#endif
void RE_Direct_Physical( const in IncidentLight directLight, const in vec3 geometryPosition, const in vec3 geometryNormal, const in vec3 geometryViewDir, const in vec3 geometryClearcoatNormal, const in PhysicalMaterial material, inout ReflectedLight reflectedLight ) {
	float dotNL = saturate( dot( geometryNormal, directLight.direction ) );
	vec3 irradiance = dotNL * directLight.color;
	#ifdef USE_CLEARCOAT
		float dotNLcc = saturate( dot( geometryClearcoatNormal, directLight.direction ) );
		vec3 ccIrradiance = dotNLcc * directLight.color;
		clearcoatSpecularDirect += ccIrradiance * BRDF_GGX_Clearcoat( directLight.direction, geometryViewDir, geometryClearcoatNormal, material );
	#endif
	#ifdef USE_SHEEN
 
 		sheenSpecularDirect += irradiance * BRDF_Sheen( directLight.direction, geometryViewDir, geometryNormal, material.sheenColor, material.sheenRoughness );
 
 		float sheenAlbedoV = IBLSheenBRDF( geometryNormal, geometryViewDir, material.sheenRoughness );
 		float sheenAlbedoL = IBLSheenBRDF( geometryNormal, directLight.direction, material.sheenRoughness );
 
 		float sheenEnergyComp = 1.0 - max3( material.sheenColor ) * max( sheenAlbedoV, sheenAlbedoL );
 
 		irradiance *= sheenEnergyComp;
 
 	#endif
	vec3 specularBRDF = BRDF_GGX( directLight.direction, geometryViewDir, geometryNormal, material );
	#ifdef USE_RETROREFLECTION
		vec3 retroViewDir = reflect( - geometryViewDir, geometryNormal );
		vec3 retroSpecularBRDF = BRDF_GGX( directLight.direction, retroViewDir, geometryNormal, material );
		specularBRDF = mix( specularBRDF, retroSpecularBRDF, saturate( material.retroreflectivity ) );
	#endif
	reflectedLight.directSpecular += irradiance * specularBRDF * material.multiScatteringCompensation;
	vec3 halfDir = normalize( directLight.direction + geometryViewDir );
	float dotVH = saturate( dot( geometryViewDir, halfDir ) );
	vec3 F = F_Schlick( material.specularColor, material.specularF90, dotVH );
	#ifdef USE_RETROREFLECTION
		vec3 retroHalfDir = normalize( directLight.direction + retroViewDir );
		float dotRetroVH = saturate( dot( retroViewDir, retroHalfDir ) );
		vec3 retroF = F_Schlick( material.specularColor, material.specularF90, dotRetroVH );
		F = mix( F, retroF, saturate( material.retroreflectivity ) );
	#endif
	#ifdef USE_DIFFUSE_ROUGHNESS
		vec3 diffuseBRDF = BRDF_EON( directLight.direction, geometryViewDir, geometryNormal, material.diffuseColor, material.diffuseRoughness ) * ( 1.0 - material.metalness );
	#else
		vec3 diffuseBRDF = BRDF_Lambert( material.diffuseContribution );
	#endif
	reflectedLight.directDiffuse += irradiance * diffuseBRDF * ( 1.0 - F );
}
void RE_IndirectDiffuse_Physical( const in vec3 irradiance, const in vec3 geometryPosition, const in vec3 geometryNormal, const in vec3 geometryViewDir, const in vec3 geometryClearcoatNormal, const in PhysicalMaterial material, inout ReflectedLight reflectedLight ) {
	vec3 singleScattering = vec3( 0.0 );
	vec3 multiScattering = vec3( 0.0 );
	#ifdef USE_IRIDESCENCE
		computeMultiscatteringIridescence( material.dfg, material.specularColor, material.specularF90, material.iridescence, material.iridescenceF0Dielectric, singleScattering, multiScattering );
	#else
		computeMultiscattering( material.dfg, material.specularColor, material.specularF90, singleScattering, multiScattering );
	#endif
	#ifdef USE_DIFFUSE_ROUGHNESS
		float dotNV = saturate( dot( geometryNormal, geometryViewDir ) );
		vec3 diffuseAlbedo = EON_DirectionalAlbedo( material.diffuseColor, material.diffuseRoughness, dotNV ) * ( 1.0 - material.metalness );
		vec3 diffuse = irradiance * RECIPROCAL_PI * diffuseAlbedo * ( 1.0 - singleScattering - multiScattering );
	#else
		vec3 diffuse = irradiance * BRDF_Lambert( material.diffuseContribution ) * ( 1.0 - singleScattering - multiScattering );
	#endif
	#ifdef USE_SHEEN
		float sheenAlbedo = IBLSheenBRDF( geometryNormal, geometryViewDir, material.sheenRoughness );
		sheenSpecularIndirect += irradiance * material.sheenColor * sheenAlbedo * RECIPROCAL_PI;
		float sheenEnergyComp = 1.0 - max3( material.sheenColor ) * sheenAlbedo;
		diffuse *= sheenEnergyComp;
	#endif
	reflectedLight.indirectDiffuse += diffuse;
}
void RE_IndirectSpecular_Physical( const in vec3 radiance, const in vec3 irradiance, const in vec3 clearcoatRadiance, const in vec3 geometryPosition, const in vec3 geometryNormal, const in vec3 geometryViewDir, const in vec3 geometryClearcoatNormal, const in PhysicalMaterial material, inout ReflectedLight reflectedLight) {
	#ifdef USE_CLEARCOAT
		clearcoatSpecularIndirect += clearcoatRadiance * EnvironmentBRDF( geometryClearcoatNormal, geometryViewDir, material.clearcoatF0, material.clearcoatF90, material.clearcoatRoughness );
	#endif
	#ifdef USE_SHEEN
		sheenSpecularIndirect += irradiance * material.sheenColor * IBLSheenBRDF( geometryNormal, geometryViewDir, material.sheenRoughness ) * RECIPROCAL_PI;
 	#endif
	vec3 singleScatteringDielectric = vec3( 0.0 );
	vec3 multiScatteringDielectric = vec3( 0.0 );
	vec3 singleScatteringMetallic = vec3( 0.0 );
	vec3 multiScatteringMetallic = vec3( 0.0 );
	#ifdef USE_IRIDESCENCE
		computeMultiscatteringIridescence( material.dfg, material.specularColor, material.specularF90, material.iridescence, material.iridescenceF0Dielectric, singleScatteringDielectric, multiScatteringDielectric );
		computeMultiscatteringIridescence( material.dfg, material.diffuseColor, material.specularF90, material.iridescence, material.iridescenceF0Metallic, singleScatteringMetallic, multiScatteringMetallic );
	#else
		computeMultiscattering( material.dfg, material.specularColor, material.specularF90, singleScatteringDielectric, multiScatteringDielectric );
		computeMultiscattering( material.dfg, material.diffuseColor, material.specularF90, singleScatteringMetallic, multiScatteringMetallic );
	#endif
	vec3 singleScattering = mix( singleScatteringDielectric, singleScatteringMetallic, material.metalness );
	vec3 multiScattering = mix( multiScatteringDielectric, multiScatteringMetallic, material.metalness );
	vec3 totalScatteringDielectric = singleScatteringDielectric + multiScatteringDielectric;
	#ifdef USE_DIFFUSE_ROUGHNESS
		float dotNV = saturate( dot( geometryNormal, geometryViewDir ) );
		vec3 diffuse = EON_DirectionalAlbedo( material.diffuseColor, material.diffuseRoughness, dotNV ) * ( 1.0 - material.metalness ) * ( 1.0 - totalScatteringDielectric );
	#else
		vec3 diffuse = material.diffuseContribution * ( 1.0 - totalScatteringDielectric );
	#endif
	vec3 cosineWeightedIrradiance = irradiance * RECIPROCAL_PI;
	vec3 indirectSpecular = radiance * singleScattering;
	indirectSpecular += multiScattering * cosineWeightedIrradiance;
	vec3 indirectDiffuse = diffuse * cosineWeightedIrradiance;
	#ifdef USE_SHEEN
		float sheenAlbedo = IBLSheenBRDF( geometryNormal, geometryViewDir, material.sheenRoughness );
		float sheenEnergyComp = 1.0 - max3( material.sheenColor ) * sheenAlbedo;
		indirectSpecular *= sheenEnergyComp;
		indirectDiffuse *= sheenEnergyComp;
	#endif
	reflectedLight.indirectSpecular += indirectSpecular;
	reflectedLight.indirectDiffuse += indirectDiffuse;
}
#define RE_Direct				RE_Direct_Physical
#define RE_Direct_RectArea		RE_Direct_RectArea_Physical
#define RE_IndirectDiffuse		RE_IndirectDiffuse_Physical
#define RE_IndirectSpecular		RE_IndirectSpecular_Physical
float computeSpecularOcclusion( const in float dotNV, const in float ambientOcclusion, const in float roughness ) {
	return saturate( pow( dotNV + ambientOcclusion, exp2( - 16.0 * roughness - 1.0 ) ) - 1.0 + ambientOcclusion );
}`,Fx=`
vec3 geometryPosition = - vViewPosition;
vec3 geometryNormal = normal;
vec3 geometryViewDir = ( isOrthographic ) ? vec3( 0, 0, 1 ) : normalize( vViewPosition );
vec3 geometryClearcoatNormal = vec3( 0.0 );
#ifdef USE_CLEARCOAT
	geometryClearcoatNormal = clearcoatNormal;
#endif
#ifdef USE_IRIDESCENCE
	float dotNVi = saturate( dot( normal, geometryViewDir ) );
	if ( material.iridescenceThickness == 0.0 ) {
		material.iridescence = 0.0;
	} else {
		material.iridescence = saturate( material.iridescence );
	}
	if ( material.iridescence > 0.0 ) {
		vec3 iridescenceFresnelDielectric = evalIridescence( 1.0, material.iridescenceIOR, dotNVi, material.iridescenceThickness, material.specularColor );
		vec3 iridescenceFresnelMetallic = evalIridescence( 1.0, material.iridescenceIOR, dotNVi, material.iridescenceThickness, material.diffuseColor );
		material.iridescenceFresnel = mix( iridescenceFresnelDielectric, iridescenceFresnelMetallic, material.metalness );
		material.iridescenceF0Dielectric = Schlick_to_F0( iridescenceFresnelDielectric, 1.0, dotNVi );
		material.iridescenceF0Metallic = Schlick_to_F0( iridescenceFresnelMetallic, 1.0, dotNVi );
	}
#endif
#ifdef STANDARD
	float dotNVms = saturate( dot( geometryNormal, geometryViewDir ) );
	material.dfg = texture2D( dfgLUT, vec2( material.roughness, dotNVms ) ).rg;
	#if ( NUM_SUN_LIGHTS > 0 || NUM_DIR_LIGHTS > 0 || NUM_POINT_LIGHTS > 0 || NUM_SPOT_LIGHTS > 0 )
		float EssMs = material.dfg.x + material.dfg.y;
		material.multiScatteringCompensation = 1.0 + material.specularColorBlended * ( 1.0 / EssMs - 1.0 );
	#endif
#endif
IncidentLight directLight;
#if ( NUM_POINT_LIGHTS > 0 ) && defined( RE_Direct )
	PointLight pointLight;
	#if defined( USE_SHADOWMAP ) && NUM_POINT_LIGHT_SHADOWS > 0
	PointLightShadow pointLightShadow;
	#endif
	#pragma unroll_loop_start
	for ( int i = 0; i < NUM_POINT_LIGHTS; i ++ ) {
		pointLight = pointLights[ i ];
		getPointLightInfo( pointLight, geometryPosition, directLight );
		#if defined( USE_SHADOWMAP ) && ( UNROLLED_LOOP_INDEX < NUM_POINT_LIGHT_SHADOWS ) && ( defined( SHADOWMAP_TYPE_PCF ) || defined( SHADOWMAP_TYPE_BASIC ) )
		pointLightShadow = pointLightShadows[ i ];
		directLight.color *= ( directLight.visible && receiveShadow ) ? getPointShadow( pointShadowMap[ i ], pointLightShadow.shadowMapSize, pointLightShadow.shadowIntensity, pointLightShadow.shadowBias, pointLightShadow.shadowRadius, vPointShadowCoord[ i ], pointLightShadow.shadowCameraNear, pointLightShadow.shadowCameraFar ) : 1.0;
		#endif
		RE_Direct( directLight, geometryPosition, geometryNormal, geometryViewDir, geometryClearcoatNormal, material, reflectedLight );
	}
	#pragma unroll_loop_end
#endif
#if ( NUM_SPOT_LIGHTS > 0 ) && defined( RE_Direct )
	SpotLight spotLight;
	vec4 spotColor;
	vec3 spotLightCoord;
	bool inSpotLightMap;
	#if defined( USE_SHADOWMAP ) && NUM_SPOT_LIGHT_SHADOWS > 0
	SpotLightShadow spotLightShadow;
	#endif
	#pragma unroll_loop_start
	for ( int i = 0; i < NUM_SPOT_LIGHTS; i ++ ) {
		spotLight = spotLights[ i ];
		getSpotLightInfo( spotLight, geometryPosition, directLight );
		#if ( UNROLLED_LOOP_INDEX < NUM_SPOT_LIGHT_SHADOWS_WITH_MAPS )
		#define SPOT_LIGHT_MAP_INDEX UNROLLED_LOOP_INDEX
		#elif ( UNROLLED_LOOP_INDEX < NUM_SPOT_LIGHT_SHADOWS )
		#define SPOT_LIGHT_MAP_INDEX NUM_SPOT_LIGHT_MAPS
		#else
		#define SPOT_LIGHT_MAP_INDEX ( UNROLLED_LOOP_INDEX - NUM_SPOT_LIGHT_SHADOWS + NUM_SPOT_LIGHT_SHADOWS_WITH_MAPS )
		#endif
		#if ( SPOT_LIGHT_MAP_INDEX < NUM_SPOT_LIGHT_MAPS )
			spotLightCoord = vSpotLightCoord[ i ].xyz / vSpotLightCoord[ i ].w;
			inSpotLightMap = all( lessThan( abs( spotLightCoord * 2. - 1. ), vec3( 1.0 ) ) );
			spotColor = texture2D( spotLightMap[ SPOT_LIGHT_MAP_INDEX ], spotLightCoord.xy );
			directLight.color = inSpotLightMap ? directLight.color * spotColor.rgb : directLight.color;
		#endif
		#undef SPOT_LIGHT_MAP_INDEX
		#if defined( USE_SHADOWMAP ) && ( UNROLLED_LOOP_INDEX < NUM_SPOT_LIGHT_SHADOWS )
		spotLightShadow = spotLightShadows[ i ];
		directLight.color *= ( directLight.visible && receiveShadow ) ? getShadow( spotShadowMap[ i ], spotLightShadow.shadowMapSize, spotLightShadow.shadowIntensity, spotLightShadow.shadowBias, spotLightShadow.shadowRadius, vSpotLightCoord[ i ] ) : 1.0;
		#endif
		RE_Direct( directLight, geometryPosition, geometryNormal, geometryViewDir, geometryClearcoatNormal, material, reflectedLight );
	}
	#pragma unroll_loop_end
#endif
#if ( NUM_SUN_LIGHTS > 0 ) && defined( RE_Direct )
	SunLight sunLight;
	#if defined( USE_SHADOWMAP ) && NUM_SUN_LIGHT_SHADOWS > 0
	SunLightShadow sunLightShadow;
	#endif
	#pragma unroll_loop_start
	for ( int i = 0; i < NUM_SUN_LIGHTS; i ++ ) {
		sunLight = sunLights[ i ];
		getSunLightInfo( sunLight, directLight );
		#if defined( USE_SHADOWMAP ) && ( UNROLLED_LOOP_INDEX < NUM_SUN_LIGHT_SHADOWS )
		sunLightShadow = sunLightShadows[ i ];
		directLight.color *= ( directLight.visible && receiveShadow ) ? getSunShadow( sunShadowMap[ i ], sunLightShadow, UNROLLED_LOOP_INDEX ) : 1.0;
		#endif
		RE_Direct( directLight, geometryPosition, geometryNormal, geometryViewDir, geometryClearcoatNormal, material, reflectedLight );
	}
	#pragma unroll_loop_end
#endif
#if ( NUM_DIR_LIGHTS > 0 ) && defined( RE_Direct )
	DirectionalLight directionalLight;
	#if defined( USE_SHADOWMAP ) && NUM_DIR_LIGHT_SHADOWS > 0
	DirectionalLightShadow directionalLightShadow;
	#endif
	#pragma unroll_loop_start
	for ( int i = 0; i < NUM_DIR_LIGHTS; i ++ ) {
		directionalLight = directionalLights[ i ];
		getDirectionalLightInfo( directionalLight, directLight );
		#if defined( USE_SHADOWMAP ) && ( UNROLLED_LOOP_INDEX < NUM_DIR_LIGHT_SHADOWS )
		directionalLightShadow = directionalLightShadows[ i ];
		directLight.color *= ( directLight.visible && receiveShadow ) ? getShadow( directionalShadowMap[ i ], directionalLightShadow.shadowMapSize, directionalLightShadow.shadowIntensity, directionalLightShadow.shadowBias, directionalLightShadow.shadowRadius, vDirectionalShadowCoord[ i ] ) : 1.0;
		#endif
		RE_Direct( directLight, geometryPosition, geometryNormal, geometryViewDir, geometryClearcoatNormal, material, reflectedLight );
	}
	#pragma unroll_loop_end
#endif
#if ( NUM_RECT_AREA_LIGHTS > 0 ) && defined( RE_Direct_RectArea )
	RectAreaLight rectAreaLight;
	#pragma unroll_loop_start
	for ( int i = 0; i < NUM_RECT_AREA_LIGHTS; i ++ ) {
		rectAreaLight = rectAreaLights[ i ];
		RE_Direct_RectArea( rectAreaLight, geometryPosition, geometryNormal, geometryViewDir, geometryClearcoatNormal, material, reflectedLight );
	}
	#pragma unroll_loop_end
#endif
#if defined( RE_IndirectDiffuse )
	vec3 iblIrradiance = vec3( 0.0 );
	vec3 irradiance = getAmbientLightIrradiance( ambientLightColor );
	#if defined( USE_LIGHT_PROBES )
		irradiance += getLightProbeIrradiance( lightProbe, geometryNormal );
	#endif
	#if ( NUM_HEMI_LIGHTS > 0 )
		#pragma unroll_loop_start
		for ( int i = 0; i < NUM_HEMI_LIGHTS; i ++ ) {
			irradiance += getHemisphereLightIrradiance( hemisphereLights[ i ], geometryNormal );
		}
		#pragma unroll_loop_end
	#endif
	#if NUM_LIGHT_PROBE_GRIDS > 0
		vec3 probeWorldPos = ( ( vec4( geometryPosition, 1.0 ) - viewMatrix[ 3 ] ) * viewMatrix ).xyz;
		vec3 probeWorldNormal = transformNormalByInverseViewMatrix( geometryNormal, viewMatrix );
		int probeGrid = - 1;
		#pragma unroll_loop_start
		for ( int i = 0; i < NUM_LIGHT_PROBE_GRIDS; i ++ ) {
			if ( isInsideLightProbeGrid( probeWorldPos, probeWorldNormal, probesMin[ i ], probesMax[ i ], probesResolution[ i ] ) ) probeGrid = UNROLLED_LOOP_INDEX;
		}
		#pragma unroll_loop_end
		#pragma unroll_loop_start
		for ( int i = 0; i < NUM_LIGHT_PROBE_GRIDS; i ++ ) {
			if ( probeGrid == UNROLLED_LOOP_INDEX ) irradiance += getLightProbeGridIrradiance( probesSH[ i ], probesMin[ i ], probesMax[ i ], probesResolution[ i ], probeWorldPos, probeWorldNormal );
		}
		#pragma unroll_loop_end
	#endif
#endif
#if defined( RE_IndirectSpecular )
	vec3 radiance = vec3( 0.0 );
	vec3 clearcoatRadiance = vec3( 0.0 );
#endif`,Bx=`#if defined( RE_IndirectDiffuse )
	#ifdef USE_LIGHTMAP
		vec4 lightMapTexel = texture2D( lightMap, vLightMapUv );
		vec3 lightMapIrradiance = lightMapTexel.rgb * lightMapIntensity;
		irradiance += lightMapIrradiance;
	#endif
	#if defined( USE_ENVMAP ) && defined( ENVMAP_TYPE_PMREM )
		#if defined( STANDARD ) || defined( LAMBERT ) || defined( PHONG )
			iblIrradiance += getIBLIrradiance( geometryNormal );
		#endif
	#endif
#endif
#if defined( USE_ENVMAP ) && defined( RE_IndirectSpecular )
	#ifdef USE_ANISOTROPY
		vec3 iblRadiance = getIBLAnisotropyRadiance( geometryViewDir, geometryNormal, material.roughness, material.anisotropyB, material.anisotropy );
	#else
		vec3 iblRadiance = getIBLRadiance( geometryViewDir, geometryNormal, material.roughness );
	#endif
	#ifdef USE_RETROREFLECTION
		#ifdef USE_ANISOTROPY
			vec3 retroIBLRadiance = getIBLAnisotropyRetroRadiance( geometryViewDir, geometryNormal, material.roughness, material.anisotropyB, material.anisotropy );
		#else
			vec3 retroIBLRadiance = getIBLRetroRadiance( geometryViewDir, geometryNormal, material.roughness );
		#endif
		iblRadiance = mix( iblRadiance, retroIBLRadiance, saturate( material.retroreflectivity ) );
	#endif
	radiance += iblRadiance;
	#ifdef USE_CLEARCOAT
		clearcoatRadiance += getIBLRadiance( geometryViewDir, geometryClearcoatNormal, material.clearcoatRoughness );
	#endif
#endif`,kx=`#if defined( RE_IndirectDiffuse )
	#if defined( LAMBERT ) || defined( PHONG )
		irradiance += iblIrradiance;
	#endif
	RE_IndirectDiffuse( irradiance, geometryPosition, geometryNormal, geometryViewDir, geometryClearcoatNormal, material, reflectedLight );
#endif
#if defined( RE_IndirectSpecular )
	RE_IndirectSpecular( radiance, iblIrradiance, clearcoatRadiance, geometryPosition, geometryNormal, geometryViewDir, geometryClearcoatNormal, material, reflectedLight );
#endif`,zx=`#if NUM_LIGHT_PROBE_GRIDS > 0
uniform highp sampler3D probesSH[ NUM_LIGHT_PROBE_GRIDS ];
uniform vec3 probesMin[ NUM_LIGHT_PROBE_GRIDS ];
uniform vec3 probesMax[ NUM_LIGHT_PROBE_GRIDS ];
uniform vec3 probesResolution[ NUM_LIGHT_PROBE_GRIDS ];
bool isInsideLightProbeGrid( vec3 worldPos, vec3 worldNormal, vec3 probesMin, vec3 probesMax, vec3 probesResolution ) {
	vec3 spacing = ( probesMax - probesMin ) / probesResolution;
	vec3 samplePos = worldPos + worldNormal * spacing * 0.5;
	vec3 margin = spacing * 0.01;
	return all( greaterThanEqual( samplePos, probesMin - margin ) ) && all( lessThanEqual( samplePos, probesMax + margin ) );
}
vec3 getLightProbeGridIrradiance( highp sampler3D probesSH, vec3 probesMin, vec3 probesMax, vec3 probesResolution, vec3 worldPos, vec3 worldNormal ) {
	vec3 res = probesResolution;
	vec3 gridRange = probesMax - probesMin;
	vec3 probeSpacing = gridRange / res;
	vec3 samplePos = worldPos + worldNormal * probeSpacing * 0.5;
	vec3 uvw = clamp( ( samplePos - probesMin ) / gridRange, 0.5 / res, 1.0 - 0.5 / res );
	float nz          = res.z;
	float paddedSlices = nz + 2.0;
	float atlasDepth  = 7.0 * paddedSlices;
	float uvZBase     = uvw.z * nz + 1.0;
	vec4 s0 = texture( probesSH, vec3( uvw.xy, ( uvZBase                       ) / atlasDepth ) );
	vec4 s1 = texture( probesSH, vec3( uvw.xy, ( uvZBase +       paddedSlices   ) / atlasDepth ) );
	vec4 s2 = texture( probesSH, vec3( uvw.xy, ( uvZBase + 2.0 * paddedSlices   ) / atlasDepth ) );
	vec4 s3 = texture( probesSH, vec3( uvw.xy, ( uvZBase + 3.0 * paddedSlices   ) / atlasDepth ) );
	vec4 s4 = texture( probesSH, vec3( uvw.xy, ( uvZBase + 4.0 * paddedSlices   ) / atlasDepth ) );
	vec4 s5 = texture( probesSH, vec3( uvw.xy, ( uvZBase + 5.0 * paddedSlices   ) / atlasDepth ) );
	vec4 s6 = texture( probesSH, vec3( uvw.xy, ( uvZBase + 6.0 * paddedSlices   ) / atlasDepth ) );
	vec3 c0 = s0.xyz;
	vec3 c1 = vec3( s0.w, s1.xy );
	vec3 c2 = vec3( s1.zw, s2.x );
	vec3 c3 = s2.yzw;
	vec3 c4 = s3.xyz;
	vec3 c5 = vec3( s3.w, s4.xy );
	vec3 c6 = vec3( s4.zw, s5.x );
	vec3 c7 = s5.yzw;
	vec3 c8 = s6.xyz;
	float x = worldNormal.x, y = worldNormal.y, z = worldNormal.z;
	vec3 result = c0 * 0.886227;
	result += c1 * 2.0 * 0.511664 * y;
	result += c2 * 2.0 * 0.511664 * z;
	result += c3 * 2.0 * 0.511664 * x;
	result += c4 * 2.0 * 0.429043 * x * y;
	result += c5 * 2.0 * 0.429043 * y * z;
	result += c6 * ( 0.743125 * z * z - 0.247708 );
	result += c7 * 2.0 * 0.429043 * x * z;
	result += c8 * 0.429043 * ( x * x - y * y );
	return max( result, vec3( 0.0 ) );
}
#endif`,Gx=`#if defined( USE_LOGARITHMIC_DEPTH_BUFFER )
	gl_FragDepth = vIsPerspective == 0.0 ? gl_FragCoord.z : log2( vFragDepth ) * logDepthBufFC * 0.5;
#endif`,Vx=`#if defined( USE_LOGARITHMIC_DEPTH_BUFFER )
	uniform float logDepthBufFC;
	varying float vFragDepth;
	varying float vIsPerspective;
#endif`,Hx=`#ifdef USE_LOGARITHMIC_DEPTH_BUFFER
	varying float vFragDepth;
	varying float vIsPerspective;
#endif`,Wx=`#ifdef USE_LOGARITHMIC_DEPTH_BUFFER
	vFragDepth = 1.0 + gl_Position.w;
	vIsPerspective = float( isPerspectiveMatrix( projectionMatrix ) );
#endif`,Xx=`#ifdef USE_MAP
	vec4 sampledDiffuseColor = texture2D( map, vMapUv );
	#ifdef DECODE_VIDEO_TEXTURE
		sampledDiffuseColor = sRGBTransferEOTF( sampledDiffuseColor );
	#endif
	diffuseColor *= sampledDiffuseColor;
#endif`,qx=`#ifdef USE_MAP
	uniform sampler2D map;
#endif`,$x=`#if defined( USE_MAP ) || defined( USE_ALPHAMAP )
	#if defined( USE_POINTS_UV )
		vec2 uv = vUv;
	#else
		vec2 uv = ( uvTransform * vec3( gl_PointCoord.x, 1.0 - gl_PointCoord.y, 1 ) ).xy;
	#endif
#endif
#ifdef USE_MAP
	diffuseColor *= texture2D( map, uv );
#endif
#ifdef USE_ALPHAMAP
	diffuseColor.a *= texture2D( alphaMap, uv ).g;
#endif`,Yx=`#if defined( USE_POINTS_UV )
	varying vec2 vUv;
#else
	#if defined( USE_MAP ) || defined( USE_ALPHAMAP )
		uniform mat3 uvTransform;
	#endif
#endif
#ifdef USE_MAP
	uniform sampler2D map;
#endif
#ifdef USE_ALPHAMAP
	uniform sampler2D alphaMap;
#endif`,Zx=`float metalnessFactor = metalness;
#ifdef USE_METALNESSMAP
	vec4 texelMetalness = texture2D( metalnessMap, vMetalnessMapUv );
	metalnessFactor *= texelMetalness.b;
#endif`,Jx=`#ifdef USE_METALNESSMAP
	uniform sampler2D metalnessMap;
#endif`,jx=`#ifdef USE_INSTANCING_MORPH
	float morphTargetInfluences[ MORPHTARGETS_COUNT ];
	float morphTargetBaseInfluence = texelFetch( morphTexture, ivec2( 0, gl_InstanceID ), 0 ).r;
	for ( int i = 0; i < MORPHTARGETS_COUNT; i ++ ) {
		morphTargetInfluences[i] =  texelFetch( morphTexture, ivec2( i + 1, gl_InstanceID ), 0 ).r;
	}
#endif`,Kx=`#if defined( USE_MORPHCOLORS )
	#if defined( USE_COLOR_ALPHA )
		vColor *= morphTargetBaseInfluence;
	#elif defined( USE_COLOR )
		vColor.rgb *= morphTargetBaseInfluence;
	#endif
	for ( int i = 0; i < MORPHTARGETS_COUNT; i ++ ) {
		#if defined( USE_COLOR_ALPHA )
			if ( morphTargetInfluences[ i ] != 0.0 ) vColor += getMorph( gl_VertexID, i, 2 ) * morphTargetInfluences[ i ];
		#elif defined( USE_COLOR )
			if ( morphTargetInfluences[ i ] != 0.0 ) vColor.rgb += getMorph( gl_VertexID, i, 2 ).rgb * morphTargetInfluences[ i ];
		#endif
	}
#endif`,Qx=`#ifdef USE_MORPHNORMALS
	objectNormal *= morphTargetBaseInfluence;
	for ( int i = 0; i < MORPHTARGETS_COUNT; i ++ ) {
		if ( morphTargetInfluences[ i ] != 0.0 ) objectNormal += getMorph( gl_VertexID, i, 1 ).xyz * morphTargetInfluences[ i ];
	}
#endif`,tv=`#ifdef USE_MORPHTARGETS
	#ifndef USE_INSTANCING_MORPH
		uniform float morphTargetBaseInfluence;
		uniform float morphTargetInfluences[ MORPHTARGETS_COUNT ];
	#endif
	uniform sampler2DArray morphTargetsTexture;
	uniform ivec2 morphTargetsTextureSize;
	vec4 getMorph( const in int vertexIndex, const in int morphTargetIndex, const in int offset ) {
		int texelIndex = vertexIndex * MORPHTARGETS_TEXTURE_STRIDE + offset;
		int y = texelIndex / morphTargetsTextureSize.x;
		int x = texelIndex - y * morphTargetsTextureSize.x;
		ivec3 morphUV = ivec3( x, y, morphTargetIndex );
		return texelFetch( morphTargetsTexture, morphUV, 0 );
	}
#endif`,ev=`#ifdef USE_MORPHTARGETS
	transformed *= morphTargetBaseInfluence;
	for ( int i = 0; i < MORPHTARGETS_COUNT; i ++ ) {
		if ( morphTargetInfluences[ i ] != 0.0 ) transformed += getMorph( gl_VertexID, i, 0 ).xyz * morphTargetInfluences[ i ];
	}
#endif`,nv=`float faceDirection = gl_FrontFacing ? 1.0 : - 1.0;
#ifdef FLAT_SHADED
	vec3 fdx = dFdx( vViewPosition );
	vec3 fdy = dFdy( vViewPosition );
	vec3 normal = normalize( cross( fdx, fdy ) );
#else
	vec3 normal = normalize( vNormal );
	#ifdef DOUBLE_SIDED
		normal *= faceDirection;
	#endif
#endif
#if defined( USE_NORMALMAP_TANGENTSPACE ) || defined( USE_CLEARCOAT_NORMALMAP ) || defined( USE_ANISOTROPY )
	#ifdef USE_TANGENT
		mat3 tbn = mat3( normalize( vTangent ), normalize( vBitangent ), normal );
	#else
		mat3 tbn = getTangentFrame( - vViewPosition, normal,
		#if defined( USE_NORMALMAP )
			vNormalMapUv
		#elif defined( USE_CLEARCOAT_NORMALMAP )
			vClearcoatNormalMapUv
		#else
			vUv
		#endif
		);
	#endif
	#ifdef DOUBLE_SIDED
		tbn[0] *= faceDirection;
		tbn[1] *= faceDirection;
	#endif
#endif
#ifdef USE_CLEARCOAT_NORMALMAP
	#ifdef USE_TANGENT
		mat3 tbn2 = mat3( normalize( vTangent ), normalize( vBitangent ), normal );
	#else
		mat3 tbn2 = getTangentFrame( - vViewPosition, normal, vClearcoatNormalMapUv );
	#endif
	#ifdef DOUBLE_SIDED
		tbn2[0] *= faceDirection;
		tbn2[1] *= faceDirection;
	#endif
#endif
vec3 nonPerturbedNormal = normal;`,iv=`#ifdef USE_NORMALMAP_OBJECTSPACE
	normal = texture2D( normalMap, vNormalMapUv ).xyz * 2.0 - 1.0;
	#ifdef FLIP_SIDED
		normal = - normal;
	#endif
	#ifdef DOUBLE_SIDED
		normal = normal * faceDirection;
	#endif
	normal = normalize( normalMatrix * normal );
#elif defined( USE_NORMALMAP_TANGENTSPACE )
	vec3 mapN = texture2D( normalMap, vNormalMapUv ).xyz * 2.0 - 1.0;
	#if defined( USE_PACKED_NORMALMAP )
		mapN = vec3( mapN.xy, sqrt( saturate( 1.0 - dot( mapN.xy, mapN.xy ) ) ) );
	#endif
	mapN.xy *= normalScale;
	normal = normalize( tbn * mapN );
#elif defined( USE_BUMPMAP )
	normal = perturbNormalArb( - vViewPosition, normal, dHdxy_fwd(), faceDirection );
#endif`,sv=`#ifndef FLAT_SHADED
	varying vec3 vNormal;
	#ifdef USE_TANGENT
		varying vec3 vTangent;
		varying vec3 vBitangent;
	#endif
#endif`,rv=`#ifndef FLAT_SHADED
	varying vec3 vNormal;
	#ifdef USE_TANGENT
		varying vec3 vTangent;
		varying vec3 vBitangent;
	#endif
#endif`,ov=`#ifndef FLAT_SHADED
	vNormal = normalize( transformedNormal );
	#ifdef USE_TANGENT
		vTangent = normalize( transformedTangent );
		vBitangent = normalize( cross( vNormal, vTangent ) * tangent.w );
		#ifdef FLIP_SIDED
			vBitangent = - vBitangent;
		#endif
	#endif
#endif`,av=`#ifdef USE_NORMALMAP
	uniform sampler2D normalMap;
	uniform vec2 normalScale;
#endif
#ifdef USE_NORMALMAP_OBJECTSPACE
	uniform mat3 normalMatrix;
#endif
#if ! defined ( USE_TANGENT ) && ( defined ( USE_NORMALMAP_TANGENTSPACE ) || defined ( USE_CLEARCOAT_NORMALMAP ) || defined( USE_ANISOTROPY ) )
	mat3 getTangentFrame( vec3 eye_pos, vec3 surf_norm, vec2 uv ) {
		vec3 q0 = dFdx( eye_pos.xyz );
		vec3 q1 = dFdy( eye_pos.xyz );
		vec2 st0 = dFdx( uv.st );
		vec2 st1 = dFdy( uv.st );
		vec3 N = surf_norm;
		vec3 q1perp = cross( q1, N );
		vec3 q0perp = cross( N, q0 );
		vec3 T = q1perp * st0.x + q0perp * st1.x;
		vec3 B = q1perp * st0.y + q0perp * st1.y;
		float det = max( dot( T, T ), dot( B, B ) );
		float scale = ( det == 0.0 ) ? 0.0 : inversesqrt( det );
		return mat3( T * scale, B * scale, N );
	}
#endif`,lv=`#ifdef USE_CLEARCOAT
	vec3 clearcoatNormal = nonPerturbedNormal;
#endif`,cv=`#ifdef USE_CLEARCOAT_NORMALMAP
	vec3 clearcoatMapN = texture2D( clearcoatNormalMap, vClearcoatNormalMapUv ).xyz * 2.0 - 1.0;
	clearcoatMapN.xy *= clearcoatNormalScale;
	clearcoatNormal = normalize( tbn2 * clearcoatMapN );
#endif`,hv=`#ifdef USE_CLEARCOATMAP
	uniform sampler2D clearcoatMap;
#endif
#ifdef USE_CLEARCOAT_NORMALMAP
	uniform sampler2D clearcoatNormalMap;
	uniform vec2 clearcoatNormalScale;
#endif
#ifdef USE_CLEARCOAT_ROUGHNESSMAP
	uniform sampler2D clearcoatRoughnessMap;
#endif`,uv=`#ifdef USE_IRIDESCENCEMAP
	uniform sampler2D iridescenceMap;
#endif
#ifdef USE_IRIDESCENCE_THICKNESSMAP
	uniform sampler2D iridescenceThicknessMap;
#endif`,dv=`#ifdef OPAQUE
diffuseColor.a = 1.0;
#endif
#ifdef USE_TRANSMISSION
diffuseColor.a *= material.transmissionAlpha;
#endif
gl_FragColor = vec4( outgoingLight, diffuseColor.a );`,fv=`vec3 packNormalToRGB( const in vec3 normal ) {
	return normalize( normal ) * 0.5 + 0.5;
}
vec3 unpackRGBToNormal( const in vec3 rgb ) {
	return 2.0 * rgb.xyz - 1.0;
}
const float PackUpscale = 256. / 255.;const float UnpackDownscale = 255. / 256.;const float ShiftRight8 = 1. / 256.;
const float Inv255 = 1. / 255.;
const vec4 PackFactors = vec4( 1.0, 256.0, 256.0 * 256.0, 256.0 * 256.0 * 256.0 );
const vec2 UnpackFactors2 = vec2( UnpackDownscale, 1.0 / PackFactors.g );
const vec3 UnpackFactors3 = vec3( UnpackDownscale / PackFactors.rg, 1.0 / PackFactors.b );
const vec4 UnpackFactors4 = vec4( UnpackDownscale / PackFactors.rgb, 1.0 / PackFactors.a );
vec4 packDepthToRGBA( const in float v ) {
	if( v <= 0.0 )
		return vec4( 0., 0., 0., 0. );
	if( v >= 1.0 )
		return vec4( 1., 1., 1., 1. );
	float vuf;
	float af = modf( v * PackFactors.a, vuf );
	float bf = modf( vuf * ShiftRight8, vuf );
	float gf = modf( vuf * ShiftRight8, vuf );
	return vec4( vuf * Inv255, gf * PackUpscale, bf * PackUpscale, af );
}
vec3 packDepthToRGB( const in float v ) {
	if( v <= 0.0 )
		return vec3( 0., 0., 0. );
	if( v >= 1.0 )
		return vec3( 1., 1., 1. );
	float vuf;
	float bf = modf( v * PackFactors.b, vuf );
	float gf = modf( vuf * ShiftRight8, vuf );
	return vec3( vuf * Inv255, gf * PackUpscale, bf );
}
vec2 packDepthToRG( const in float v ) {
	if( v <= 0.0 )
		return vec2( 0., 0. );
	if( v >= 1.0 )
		return vec2( 1., 1. );
	float vuf;
	float gf = modf( v * 256., vuf );
	return vec2( vuf * Inv255, gf );
}
float unpackRGBAToDepth( const in vec4 v ) {
	return dot( v, UnpackFactors4 );
}
float unpackRGBToDepth( const in vec3 v ) {
	return dot( v, UnpackFactors3 );
}
float unpackRGToDepth( const in vec2 v ) {
	return v.r * UnpackFactors2.r + v.g * UnpackFactors2.g;
}
vec4 pack2HalfToRGBA( const in vec2 v ) {
	vec4 r = vec4( v.x, fract( v.x * 255.0 ), v.y, fract( v.y * 255.0 ) );
	return vec4( r.x - r.y / 255.0, r.y, r.z - r.w / 255.0, r.w );
}
vec2 unpackRGBATo2Half( const in vec4 v ) {
	return vec2( v.x + ( v.y / 255.0 ), v.z + ( v.w / 255.0 ) );
}
float viewZToOrthographicDepth( const in float viewZ, const in float near, const in float far ) {
	return ( viewZ + near ) / ( near - far );
}
float orthographicDepthToViewZ( const in float depth, const in float near, const in float far ) {
	#ifdef USE_REVERSED_DEPTH_BUFFER
	
		return depth * ( far - near ) - far;
	#else
		return depth * ( near - far ) - near;
	#endif
}
float viewZToPerspectiveDepth( const in float viewZ, const in float near, const in float far ) {
	return ( ( near + viewZ ) * far ) / ( ( far - near ) * viewZ );
}
float perspectiveDepthToViewZ( const in float depth, const in float near, const in float far ) {
	
	#ifdef USE_REVERSED_DEPTH_BUFFER
		return ( near * far ) / ( ( near - far ) * depth - near );
	#else
		return ( near * far ) / ( ( far - near ) * depth - far );
	#endif
}`,pv=`#ifdef PREMULTIPLIED_ALPHA
	gl_FragColor.rgb *= gl_FragColor.a;
#endif`,mv=`vec4 mvPosition = vec4( transformed, 1.0 );
#ifdef USE_BATCHING
	mvPosition = batchingMatrix * mvPosition;
#endif
#ifdef USE_INSTANCING
	mvPosition = instanceMatrix * mvPosition;
#endif
mvPosition = modelViewMatrix * mvPosition;
gl_Position = projectionMatrix * mvPosition;`,gv=`#ifdef DITHERING
	gl_FragColor.rgb = dithering( gl_FragColor.rgb );
#endif`,_v=`#ifdef DITHERING
	vec3 dithering( vec3 color ) {
		float grid_position = rand( gl_FragCoord.xy );
		vec3 dither_shift_RGB = vec3( 0.25 / 255.0, -0.25 / 255.0, 0.25 / 255.0 );
		dither_shift_RGB = mix( 2.0 * dither_shift_RGB, -2.0 * dither_shift_RGB, grid_position );
		return color + dither_shift_RGB;
	}
#endif`,xv=`float roughnessFactor = roughness;
#ifdef USE_ROUGHNESSMAP
	vec4 texelRoughness = texture2D( roughnessMap, vRoughnessMapUv );
	roughnessFactor *= texelRoughness.g;
#endif`,vv=`#ifdef USE_ROUGHNESSMAP
	uniform sampler2D roughnessMap;
#endif`,yv=`#if NUM_SPOT_LIGHT_COORDS > 0
	varying vec4 vSpotLightCoord[ NUM_SPOT_LIGHT_COORDS ];
#endif
#if NUM_SPOT_LIGHT_MAPS > 0
	uniform sampler2D spotLightMap[ NUM_SPOT_LIGHT_MAPS ];
#endif
#ifdef USE_SHADOWMAP
	#if NUM_SUN_LIGHT_SHADOWS > 0
		#define SUN_LIGHT_CASCADES 2
		#if defined( SHADOWMAP_TYPE_PCF )
			uniform sampler2DShadow sunShadowMap[ NUM_SUN_LIGHT_SHADOWS ];
		#else
			uniform sampler2D sunShadowMap[ NUM_SUN_LIGHT_SHADOWS ];
		#endif
		uniform mat4 sunShadowMatrix[ NUM_SUN_LIGHT_SHADOWS * SUN_LIGHT_CASCADES ];
		uniform vec4 sunShadowCascade[ NUM_SUN_LIGHT_SHADOWS * SUN_LIGHT_CASCADES ];
		varying vec4 vSunShadowWorldPosition;
		varying vec3 vSunShadowWorldNormal;
		struct SunLightShadow {
			float shadowIntensity;
			float shadowBias;
			float shadowNormalBias;
			float shadowRadius;
			vec2 shadowMapSize;
		};
		uniform SunLightShadow sunLightShadows[ NUM_SUN_LIGHT_SHADOWS ];
	#endif
	#if NUM_DIR_LIGHT_SHADOWS > 0
		#if defined( SHADOWMAP_TYPE_PCF )
			uniform sampler2DShadow directionalShadowMap[ NUM_DIR_LIGHT_SHADOWS ];
		#else
			uniform sampler2D directionalShadowMap[ NUM_DIR_LIGHT_SHADOWS ];
		#endif
		varying vec4 vDirectionalShadowCoord[ NUM_DIR_LIGHT_SHADOWS ];
		struct DirectionalLightShadow {
			float shadowIntensity;
			float shadowBias;
			float shadowNormalBias;
			float shadowRadius;
			vec2 shadowMapSize;
		};
		uniform DirectionalLightShadow directionalLightShadows[ NUM_DIR_LIGHT_SHADOWS ];
	#endif
	#if NUM_SPOT_LIGHT_SHADOWS > 0
		#if defined( SHADOWMAP_TYPE_PCF )
			uniform sampler2DShadow spotShadowMap[ NUM_SPOT_LIGHT_SHADOWS ];
		#else
			uniform sampler2D spotShadowMap[ NUM_SPOT_LIGHT_SHADOWS ];
		#endif
		struct SpotLightShadow {
			float shadowIntensity;
			float shadowBias;
			float shadowNormalBias;
			float shadowRadius;
			vec2 shadowMapSize;
		};
		uniform SpotLightShadow spotLightShadows[ NUM_SPOT_LIGHT_SHADOWS ];
	#endif
	#if NUM_POINT_LIGHT_SHADOWS > 0
		#if defined( SHADOWMAP_TYPE_PCF )
			uniform samplerCubeShadow pointShadowMap[ NUM_POINT_LIGHT_SHADOWS ];
		#elif defined( SHADOWMAP_TYPE_BASIC )
			uniform samplerCube pointShadowMap[ NUM_POINT_LIGHT_SHADOWS ];
		#endif
		varying vec4 vPointShadowCoord[ NUM_POINT_LIGHT_SHADOWS ];
		struct PointLightShadow {
			float shadowIntensity;
			float shadowBias;
			float shadowNormalBias;
			float shadowRadius;
			vec2 shadowMapSize;
			float shadowCameraNear;
			float shadowCameraFar;
		};
		uniform PointLightShadow pointLightShadows[ NUM_POINT_LIGHT_SHADOWS ];
	#endif
	#if defined( SHADOWMAP_TYPE_PCF )
		float interleavedGradientNoise( vec2 position ) {
			return fract( 52.9829189 * fract( dot( position, vec2( 0.06711056, 0.00583715 ) ) ) );
		}
		vec2 vogelDiskSample( int sampleIndex, int samplesCount, float phi ) {
			const float goldenAngle = 2.399963229728653;
			float r = sqrt( ( float( sampleIndex ) + 0.5 ) / float( samplesCount ) );
			float theta = float( sampleIndex ) * goldenAngle + phi;
			return vec2( cos( theta ), sin( theta ) ) * r;
		}
	#endif
	#if defined( SHADOWMAP_TYPE_PCF )
		float getShadow( sampler2DShadow shadowMap, vec2 shadowMapSize, float shadowIntensity, float shadowBias, float shadowRadius, vec4 shadowCoord ) {
			float shadow = 1.0;
			shadowCoord.xyz /= shadowCoord.w;
			#ifdef USE_REVERSED_DEPTH_BUFFER
				shadowCoord.z -= shadowBias;
			#else
				shadowCoord.z += shadowBias;
			#endif
			bool inFrustum = shadowCoord.x >= 0.0 && shadowCoord.x <= 1.0 && shadowCoord.y >= 0.0 && shadowCoord.y <= 1.0;
			bool frustumTest = inFrustum && shadowCoord.z <= 1.0;
			if ( frustumTest ) {
				vec2 texelSize = vec2( 1.0 ) / shadowMapSize;
				vec2 radius = shadowRadius * texelSize;
				float phi = interleavedGradientNoise( gl_FragCoord.xy ) * PI2;
				shadow = (
					texture( shadowMap, vec3( shadowCoord.xy + vogelDiskSample( 0, 5, phi ) * radius, shadowCoord.z ) ) +
					texture( shadowMap, vec3( shadowCoord.xy + vogelDiskSample( 1, 5, phi ) * radius, shadowCoord.z ) ) +
					texture( shadowMap, vec3( shadowCoord.xy + vogelDiskSample( 2, 5, phi ) * radius, shadowCoord.z ) ) +
					texture( shadowMap, vec3( shadowCoord.xy + vogelDiskSample( 3, 5, phi ) * radius, shadowCoord.z ) ) +
					texture( shadowMap, vec3( shadowCoord.xy + vogelDiskSample( 4, 5, phi ) * radius, shadowCoord.z ) )
				) * 0.2;
			}
			return mix( 1.0, shadow, shadowIntensity );
		}
	#elif defined( SHADOWMAP_TYPE_VSM )
		float getShadow( sampler2D shadowMap, vec2 shadowMapSize, float shadowIntensity, float shadowBias, float shadowRadius, vec4 shadowCoord ) {
			float shadow = 1.0;
			shadowCoord.xyz /= shadowCoord.w;
			#ifdef USE_REVERSED_DEPTH_BUFFER
				shadowCoord.z -= shadowBias;
			#else
				shadowCoord.z += shadowBias;
			#endif
			bool inFrustum = shadowCoord.x >= 0.0 && shadowCoord.x <= 1.0 && shadowCoord.y >= 0.0 && shadowCoord.y <= 1.0;
			bool frustumTest = inFrustum && shadowCoord.z <= 1.0;
			if ( frustumTest ) {
				vec2 distribution = texture2D( shadowMap, shadowCoord.xy ).rg;
				float mean = distribution.x;
				float variance = distribution.y * distribution.y;
				#ifdef USE_REVERSED_DEPTH_BUFFER
					float hard_shadow = step( mean, shadowCoord.z );
				#else
					float hard_shadow = step( shadowCoord.z, mean );
				#endif
				
				if ( hard_shadow == 1.0 ) {
					shadow = 1.0;
				} else {
					variance = max( variance, 0.0000001 );
					float d = shadowCoord.z - mean;
					float p_max = variance / ( variance + d * d );
					p_max = clamp( ( p_max - 0.3 ) / 0.65, 0.0, 1.0 );
					shadow = max( hard_shadow, p_max );
				}
			}
			return mix( 1.0, shadow, shadowIntensity );
		}
	#else
		float getShadow( sampler2D shadowMap, vec2 shadowMapSize, float shadowIntensity, float shadowBias, float shadowRadius, vec4 shadowCoord ) {
			float shadow = 1.0;
			shadowCoord.xyz /= shadowCoord.w;
			#ifdef USE_REVERSED_DEPTH_BUFFER
				shadowCoord.z -= shadowBias;
			#else
				shadowCoord.z += shadowBias;
			#endif
			bool inFrustum = shadowCoord.x >= 0.0 && shadowCoord.x <= 1.0 && shadowCoord.y >= 0.0 && shadowCoord.y <= 1.0;
			bool frustumTest = inFrustum && shadowCoord.z <= 1.0;
			if ( frustumTest ) {
				float depth = texture2D( shadowMap, shadowCoord.xy ).r;
				#ifdef USE_REVERSED_DEPTH_BUFFER
					shadow = step( depth, shadowCoord.z );
				#else
					shadow = step( shadowCoord.z, depth );
				#endif
			}
			return mix( 1.0, shadow, shadowIntensity );
		}
	#endif
	#if NUM_SUN_LIGHT_SHADOWS > 0
		float getSunShadow(
			#if defined( SHADOWMAP_TYPE_PCF )
				sampler2DShadow shadowMap,
			#else
				sampler2D shadowMap,
			#endif
			SunLightShadow sunLightShadow,
			int shadowIndex
		) {
			vec4 shadowWorldPosition = vec4( vSunShadowWorldPosition.xyz + vSunShadowWorldNormal * sunLightShadow.shadowNormalBias, 1.0 );
			float viewDepth = vSunShadowWorldPosition.w;
			int cascadeOffset = shadowIndex * SUN_LIGHT_CASCADES;
			float shadow = 1.0;
			for ( int i = SUN_LIGHT_CASCADES - 1; i >= 0; i -- ) {
				vec4 cascade = sunShadowCascade[ cascadeOffset + i ];
				if ( viewDepth >= cascade.x && viewDepth < cascade.y ) {
					float cascadeShadow = getShadow(
						shadowMap,
						sunLightShadow.shadowMapSize,
						sunLightShadow.shadowIntensity,
						sunLightShadow.shadowBias,
						sunLightShadow.shadowRadius,
						sunShadowMatrix[ cascadeOffset + i ] * shadowWorldPosition
					);
					shadow = mix( cascadeShadow, shadow, smoothstep( cascade.z, cascade.y, viewDepth ) );
				}
			}
			return shadow;
		}
	#endif
	#if NUM_POINT_LIGHT_SHADOWS > 0
	#if defined( SHADOWMAP_TYPE_PCF )
	float getPointShadow( samplerCubeShadow shadowMap, vec2 shadowMapSize, float shadowIntensity, float shadowBias, float shadowRadius, vec4 shadowCoord, float shadowCameraNear, float shadowCameraFar ) {
		float shadow = 1.0;
		vec3 lightToPosition = shadowCoord.xyz;
		vec3 bd3D = normalize( lightToPosition );
		vec3 absVec = abs( lightToPosition );
		float viewSpaceZ = max( max( absVec.x, absVec.y ), absVec.z );
		if ( viewSpaceZ - shadowCameraFar <= 0.0 && viewSpaceZ - shadowCameraNear >= 0.0 ) {
			float lightDistance = length( lightToPosition );
			float depthRange = shadowCameraFar - shadowCameraNear;
			#ifdef USE_REVERSED_DEPTH_BUFFER
				float depthA = - shadowCameraNear / depthRange - shadowBias;
				float depthB = shadowCameraNear * shadowCameraFar / ( depthRange * lightDistance );
			#else
				float depthA = shadowCameraFar / depthRange + shadowBias;
				float depthB = - shadowCameraNear * shadowCameraFar / ( depthRange * lightDistance );
			#endif
			float texelSize = shadowRadius / shadowMapSize.x;
			vec3 absDir = abs( bd3D );
			vec3 tangent = absDir.x > absDir.z ? vec3( 0.0, 1.0, 0.0 ) : vec3( 1.0, 0.0, 0.0 );
			tangent = normalize( cross( bd3D, tangent ) );
			vec3 bitangent = cross( bd3D, tangent );
			float phi = interleavedGradientNoise( gl_FragCoord.xy ) * PI2;
			shadow = 0.0;
			for ( int i = 0; i < 5; i ++ ) {
				vec2 offset = vogelDiskSample( i, 5, phi );
				vec3 direction = bd3D + ( tangent * offset.x + bitangent * offset.y ) * texelSize;
				vec3 absDirection = abs( direction );
				float dp = depthA + depthB / max( max( absDirection.x, absDirection.y ), absDirection.z );
				shadow += texture( shadowMap, vec4( direction, dp ) );
			}
			shadow *= 0.2;
		}
		return mix( 1.0, shadow, shadowIntensity );
	}
	#elif defined( SHADOWMAP_TYPE_BASIC )
	float getPointShadow( samplerCube shadowMap, vec2 shadowMapSize, float shadowIntensity, float shadowBias, float shadowRadius, vec4 shadowCoord, float shadowCameraNear, float shadowCameraFar ) {
		float shadow = 1.0;
		vec3 lightToPosition = shadowCoord.xyz;
		vec3 absVec = abs( lightToPosition );
		float viewSpaceZ = max( max( absVec.x, absVec.y ), absVec.z );
		if ( viewSpaceZ - shadowCameraFar <= 0.0 && viewSpaceZ - shadowCameraNear >= 0.0 ) {
			float dp = ( shadowCameraFar * ( viewSpaceZ - shadowCameraNear ) ) / ( viewSpaceZ * ( shadowCameraFar - shadowCameraNear ) );
			dp += shadowBias;
			vec3 bd3D = normalize( lightToPosition );
			float depth = textureCube( shadowMap, bd3D ).r;
			#ifdef USE_REVERSED_DEPTH_BUFFER
				depth = 1.0 - depth;
			#endif
			shadow = step( dp, depth );
		}
		return mix( 1.0, shadow, shadowIntensity );
	}
	#endif
	#endif
#endif`,bv=`#if NUM_SPOT_LIGHT_COORDS > 0
	uniform mat4 spotLightMatrix[ NUM_SPOT_LIGHT_COORDS ];
	varying vec4 vSpotLightCoord[ NUM_SPOT_LIGHT_COORDS ];
#endif
#ifdef USE_SHADOWMAP
	#if NUM_SUN_LIGHT_SHADOWS > 0
		varying vec4 vSunShadowWorldPosition;
		varying vec3 vSunShadowWorldNormal;
	#endif
	#if NUM_DIR_LIGHT_SHADOWS > 0
		uniform mat4 directionalShadowMatrix[ NUM_DIR_LIGHT_SHADOWS ];
		varying vec4 vDirectionalShadowCoord[ NUM_DIR_LIGHT_SHADOWS ];
		struct DirectionalLightShadow {
			float shadowIntensity;
			float shadowBias;
			float shadowNormalBias;
			float shadowRadius;
			vec2 shadowMapSize;
		};
		uniform DirectionalLightShadow directionalLightShadows[ NUM_DIR_LIGHT_SHADOWS ];
	#endif
	#if NUM_SPOT_LIGHT_SHADOWS > 0
		struct SpotLightShadow {
			float shadowIntensity;
			float shadowBias;
			float shadowNormalBias;
			float shadowRadius;
			vec2 shadowMapSize;
		};
		uniform SpotLightShadow spotLightShadows[ NUM_SPOT_LIGHT_SHADOWS ];
	#endif
	#if NUM_POINT_LIGHT_SHADOWS > 0
		uniform mat4 pointShadowMatrix[ NUM_POINT_LIGHT_SHADOWS ];
		varying vec4 vPointShadowCoord[ NUM_POINT_LIGHT_SHADOWS ];
		struct PointLightShadow {
			float shadowIntensity;
			float shadowBias;
			float shadowNormalBias;
			float shadowRadius;
			vec2 shadowMapSize;
			float shadowCameraNear;
			float shadowCameraFar;
		};
		uniform PointLightShadow pointLightShadows[ NUM_POINT_LIGHT_SHADOWS ];
	#endif
#endif`,Mv=`#if ( defined( USE_SHADOWMAP ) && ( NUM_DIR_LIGHT_SHADOWS > 0 || NUM_SUN_LIGHT_SHADOWS > 0 || NUM_POINT_LIGHT_SHADOWS > 0 ) ) || ( NUM_SPOT_LIGHT_COORDS > 0 )
	#ifdef HAS_NORMAL
		vec3 shadowWorldNormal = transformNormalByInverseViewMatrix( transformedNormal, viewMatrix );
	#else
		vec3 shadowWorldNormal = vec3( 0.0 );
	#endif
	vec4 shadowWorldPosition;
#endif
#if defined( USE_SHADOWMAP )
	#if NUM_SUN_LIGHT_SHADOWS > 0
		vSunShadowWorldPosition = vec4( worldPosition.xyz, - mvPosition.z );
		vSunShadowWorldNormal = shadowWorldNormal;
	#endif
	#if NUM_DIR_LIGHT_SHADOWS > 0
		#pragma unroll_loop_start
		for ( int i = 0; i < NUM_DIR_LIGHT_SHADOWS; i ++ ) {
			shadowWorldPosition = worldPosition + vec4( shadowWorldNormal * directionalLightShadows[ i ].shadowNormalBias, 0 );
			vDirectionalShadowCoord[ i ] = directionalShadowMatrix[ i ] * shadowWorldPosition;
		}
		#pragma unroll_loop_end
	#endif
	#if NUM_POINT_LIGHT_SHADOWS > 0
		#pragma unroll_loop_start
		for ( int i = 0; i < NUM_POINT_LIGHT_SHADOWS; i ++ ) {
			shadowWorldPosition = worldPosition + vec4( shadowWorldNormal * pointLightShadows[ i ].shadowNormalBias, 0 );
			vPointShadowCoord[ i ] = pointShadowMatrix[ i ] * shadowWorldPosition;
		}
		#pragma unroll_loop_end
	#endif
#endif
#if NUM_SPOT_LIGHT_COORDS > 0
	#pragma unroll_loop_start
	for ( int i = 0; i < NUM_SPOT_LIGHT_COORDS; i ++ ) {
		shadowWorldPosition = worldPosition;
		#if ( defined( USE_SHADOWMAP ) && UNROLLED_LOOP_INDEX < NUM_SPOT_LIGHT_SHADOWS )
			shadowWorldPosition.xyz += shadowWorldNormal * spotLightShadows[ i ].shadowNormalBias;
		#endif
		vSpotLightCoord[ i ] = spotLightMatrix[ i ] * shadowWorldPosition;
	}
	#pragma unroll_loop_end
#endif`,Sv=`float getShadowMask() {
	float shadow = 1.0;
	#ifdef USE_SHADOWMAP
	#if NUM_SUN_LIGHT_SHADOWS > 0
	SunLightShadow sunLight;
	#pragma unroll_loop_start
	for ( int i = 0; i < NUM_SUN_LIGHT_SHADOWS; i ++ ) {
		sunLight = sunLightShadows[ i ];
		shadow *= receiveShadow ? getSunShadow( sunShadowMap[ i ], sunLight, UNROLLED_LOOP_INDEX ) : 1.0;
	}
	#pragma unroll_loop_end
	#endif
	#if NUM_DIR_LIGHT_SHADOWS > 0
	DirectionalLightShadow directionalLight;
	#pragma unroll_loop_start
	for ( int i = 0; i < NUM_DIR_LIGHT_SHADOWS; i ++ ) {
		directionalLight = directionalLightShadows[ i ];
		shadow *= receiveShadow ? getShadow( directionalShadowMap[ i ], directionalLight.shadowMapSize, directionalLight.shadowIntensity, directionalLight.shadowBias, directionalLight.shadowRadius, vDirectionalShadowCoord[ i ] ) : 1.0;
	}
	#pragma unroll_loop_end
	#endif
	#if NUM_SPOT_LIGHT_SHADOWS > 0
	SpotLightShadow spotLight;
	#pragma unroll_loop_start
	for ( int i = 0; i < NUM_SPOT_LIGHT_SHADOWS; i ++ ) {
		spotLight = spotLightShadows[ i ];
		shadow *= receiveShadow ? getShadow( spotShadowMap[ i ], spotLight.shadowMapSize, spotLight.shadowIntensity, spotLight.shadowBias, spotLight.shadowRadius, vSpotLightCoord[ i ] ) : 1.0;
	}
	#pragma unroll_loop_end
	#endif
	#if NUM_POINT_LIGHT_SHADOWS > 0 && ( defined( SHADOWMAP_TYPE_PCF ) || defined( SHADOWMAP_TYPE_BASIC ) )
	PointLightShadow pointLight;
	#pragma unroll_loop_start
	for ( int i = 0; i < NUM_POINT_LIGHT_SHADOWS; i ++ ) {
		pointLight = pointLightShadows[ i ];
		shadow *= receiveShadow ? getPointShadow( pointShadowMap[ i ], pointLight.shadowMapSize, pointLight.shadowIntensity, pointLight.shadowBias, pointLight.shadowRadius, vPointShadowCoord[ i ], pointLight.shadowCameraNear, pointLight.shadowCameraFar ) : 1.0;
	}
	#pragma unroll_loop_end
	#endif
	#endif
	return shadow;
}`,wv=`#ifdef USE_SKINNING
	mat4 boneMatX = getBoneMatrix( skinIndex.x );
	mat4 boneMatY = getBoneMatrix( skinIndex.y );
	mat4 boneMatZ = getBoneMatrix( skinIndex.z );
	mat4 boneMatW = getBoneMatrix( skinIndex.w );
#endif`,Ev=`#ifdef USE_SKINNING
	uniform mat4 bindMatrix;
	uniform mat4 bindMatrixInverse;
	uniform highp sampler2D boneTexture;
	mat4 getBoneMatrix( const in float i ) {
		int size = textureSize( boneTexture, 0 ).x;
		int j = int( i ) * 4;
		int x = j % size;
		int y = j / size;
		vec4 v1 = texelFetch( boneTexture, ivec2( x, y ), 0 );
		vec4 v2 = texelFetch( boneTexture, ivec2( x + 1, y ), 0 );
		vec4 v3 = texelFetch( boneTexture, ivec2( x + 2, y ), 0 );
		vec4 v4 = texelFetch( boneTexture, ivec2( x + 3, y ), 0 );
		return mat4( v1, v2, v3, v4 );
	}
#endif`,Av=`#ifdef USE_SKINNING
	vec4 skinVertex = bindMatrix * vec4( transformed, 1.0 );
	vec4 skinned = vec4( 0.0 );
	skinned += boneMatX * skinVertex * skinWeight.x;
	skinned += boneMatY * skinVertex * skinWeight.y;
	skinned += boneMatZ * skinVertex * skinWeight.z;
	skinned += boneMatW * skinVertex * skinWeight.w;
	transformed = ( bindMatrixInverse * skinned ).xyz;
#endif`,Tv=`#ifdef USE_SKINNING
	mat4 skinMatrix = mat4( 0.0 );
	skinMatrix += skinWeight.x * boneMatX;
	skinMatrix += skinWeight.y * boneMatY;
	skinMatrix += skinWeight.z * boneMatZ;
	skinMatrix += skinWeight.w * boneMatW;
	skinMatrix = bindMatrixInverse * skinMatrix * bindMatrix;
	objectNormal = vec4( skinMatrix * vec4( objectNormal, 0.0 ) ).xyz;
	#ifdef USE_TANGENT
		objectTangent = vec4( skinMatrix * vec4( objectTangent, 0.0 ) ).xyz;
	#endif
#endif`,Cv=`float specularStrength;
#ifdef USE_SPECULARMAP
	vec4 texelSpecular = texture2D( specularMap, vSpecularMapUv );
	specularStrength = texelSpecular.r;
#else
	specularStrength = 1.0;
#endif`,Rv=`#ifdef USE_SPECULARMAP
	uniform sampler2D specularMap;
#endif`,Pv=`#if defined( TONE_MAPPING )
	gl_FragColor.rgb = toneMapping( gl_FragColor.rgb );
#endif`,Iv=`#ifndef saturate
#define saturate( a ) clamp( a, 0.0, 1.0 )
#endif
uniform float toneMappingExposure;
vec3 LinearToneMapping( vec3 color ) {
	return saturate( toneMappingExposure * color );
}
vec3 ReinhardToneMapping( vec3 color ) {
	color *= toneMappingExposure;
	return saturate( color / ( vec3( 1.0 ) + color ) );
}
vec3 CineonToneMapping( vec3 color ) {
	color *= toneMappingExposure;
	color = max( vec3( 0.0 ), color - 0.004 );
	return pow( ( color * ( 6.2 * color + 0.5 ) ) / ( color * ( 6.2 * color + 1.7 ) + 0.06 ), vec3( 2.2 ) );
}
vec3 RRTAndODTFit( vec3 v ) {
	vec3 a = v * ( v + 0.0245786 ) - 0.000090537;
	vec3 b = v * ( 0.983729 * v + 0.4329510 ) + 0.238081;
	return a / b;
}
vec3 ACESFilmicToneMapping( vec3 color ) {
	const mat3 ACESInputMat = mat3(
		vec3( 0.59719, 0.07600, 0.02840 ),		vec3( 0.35458, 0.90834, 0.13383 ),
		vec3( 0.04823, 0.01566, 0.83777 )
	);
	const mat3 ACESOutputMat = mat3(
		vec3(  1.60475, -0.10208, -0.00327 ),		vec3( -0.53108,  1.10813, -0.07276 ),
		vec3( -0.07367, -0.00605,  1.07602 )
	);
	color *= toneMappingExposure / 0.6;
	color = ACESInputMat * color;
	color = RRTAndODTFit( color );
	color = ACESOutputMat * color;
	return saturate( color );
}
const mat3 LINEAR_REC2020_TO_LINEAR_SRGB = mat3(
	vec3( 1.6605, - 0.1246, - 0.0182 ),
	vec3( - 0.5876, 1.1329, - 0.1006 ),
	vec3( - 0.0728, - 0.0083, 1.1187 )
);
const mat3 LINEAR_SRGB_TO_LINEAR_REC2020 = mat3(
	vec3( 0.6274, 0.0691, 0.0164 ),
	vec3( 0.3293, 0.9195, 0.0880 ),
	vec3( 0.0433, 0.0113, 0.8956 )
);
vec3 agxDefaultContrastApprox( vec3 x ) {
	vec3 x2 = x * x;
	vec3 x4 = x2 * x2;
	return + 15.5 * x4 * x2
		- 40.14 * x4 * x
		+ 31.96 * x4
		- 6.868 * x2 * x
		+ 0.4298 * x2
		+ 0.1191 * x
		- 0.00232;
}
vec3 AgXToneMapping( vec3 color ) {
	const mat3 AgXInsetMatrix = mat3(
		vec3( 0.856627153315983, 0.137318972929847, 0.11189821299995 ),
		vec3( 0.0951212405381588, 0.761241990602591, 0.0767994186031903 ),
		vec3( 0.0482516061458583, 0.101439036467562, 0.811302368396859 )
	);
	const mat3 AgXOutsetMatrix = mat3(
		vec3( 1.1271005818144368, - 0.1413297634984383, - 0.14132976349843826 ),
		vec3( - 0.11060664309660323, 1.157823702216272, - 0.11060664309660294 ),
		vec3( - 0.016493938717834573, - 0.016493938717834257, 1.2519364065950405 )
	);
	const float AgxMinEv = - 12.47393;	const float AgxMaxEv = 4.026069;
	color *= toneMappingExposure;
	color = LINEAR_SRGB_TO_LINEAR_REC2020 * color;
	color = AgXInsetMatrix * color;
	color = max( color, 1e-10 );	color = log2( color );
	color = ( color - AgxMinEv ) / ( AgxMaxEv - AgxMinEv );
	color = clamp( color, 0.0, 1.0 );
	color = agxDefaultContrastApprox( color );
	color = AgXOutsetMatrix * color;
	color = pow( max( vec3( 0.0 ), color ), vec3( 2.2 ) );
	color = LINEAR_REC2020_TO_LINEAR_SRGB * color;
	color = clamp( color, 0.0, 1.0 );
	return color;
}
vec3 NeutralToneMapping( vec3 color ) {
	const float StartCompression = 0.8 - 0.04;
	const float Desaturation = 0.15;
	color *= toneMappingExposure;
	float x = min( color.r, min( color.g, color.b ) );
	float offset = x < 0.08 ? x - 6.25 * x * x : 0.04;
	color -= offset;
	float peak = max( color.r, max( color.g, color.b ) );
	if ( peak < StartCompression ) return color;
	float d = 1. - StartCompression;
	float newPeak = 1. - d * d / ( peak + d - StartCompression );
	color *= newPeak / peak;
	float g = 1. - 1. / ( Desaturation * ( peak - newPeak ) + 1. );
	return mix( color, vec3( newPeak ), g );
}
vec3 CustomToneMapping( vec3 color ) { return color; }`,Lv=`#ifdef USE_TRANSMISSION
	material.transmission = transmission;
	material.transmissionAlpha = 1.0;
	material.thickness = thickness;
	material.attenuationDistance = attenuationDistance;
	material.attenuationColor = attenuationColor;
	#ifdef USE_TRANSMISSIONMAP
		material.transmission *= texture2D( transmissionMap, vTransmissionMapUv ).r;
	#endif
	#ifdef USE_THICKNESSMAP
		material.thickness *= texture2D( thicknessMap, vThicknessMapUv ).g;
	#endif
	vec3 pos = vWorldPosition;
	vec3 v = normalize( cameraPosition - pos );
	vec3 n = transformNormalByInverseViewMatrix( normal, viewMatrix );
	vec4 transmitted = getIBLVolumeRefraction(
		n, v, material.roughness, material.diffuseContribution, material.specularColorBlended, material.specularF90,
		pos, modelMatrix, viewMatrix, projectionMatrix, material.dispersion, material.ior, material.thickness,
		material.attenuationColor, material.attenuationDistance );
	material.transmissionAlpha = mix( material.transmissionAlpha, transmitted.a, material.transmission );
	totalDiffuse = mix( totalDiffuse, transmitted.rgb, material.transmission );
#endif`,Dv=`#ifdef USE_TRANSMISSION
	uniform float transmission;
	uniform float thickness;
	uniform float attenuationDistance;
	uniform vec3 attenuationColor;
	#ifdef USE_TRANSMISSIONMAP
		uniform sampler2D transmissionMap;
	#endif
	#ifdef USE_THICKNESSMAP
		uniform sampler2D thicknessMap;
	#endif
	uniform vec2 transmissionSamplerSize;
	uniform sampler2D transmissionSamplerMap;
	uniform mat4 modelMatrix;
	uniform mat4 projectionMatrix;
	varying vec3 vWorldPosition;
	float w0( float a ) {
		return ( 1.0 / 6.0 ) * ( a * ( a * ( - a + 3.0 ) - 3.0 ) + 1.0 );
	}
	float w1( float a ) {
		return ( 1.0 / 6.0 ) * ( a *  a * ( 3.0 * a - 6.0 ) + 4.0 );
	}
	float w2( float a ){
		return ( 1.0 / 6.0 ) * ( a * ( a * ( - 3.0 * a + 3.0 ) + 3.0 ) + 1.0 );
	}
	float w3( float a ) {
		return ( 1.0 / 6.0 ) * ( a * a * a );
	}
	float g0( float a ) {
		return w0( a ) + w1( a );
	}
	float g1( float a ) {
		return w2( a ) + w3( a );
	}
	float h0( float a ) {
		return - 1.0 + w1( a ) / ( w0( a ) + w1( a ) );
	}
	float h1( float a ) {
		return 1.0 + w3( a ) / ( w2( a ) + w3( a ) );
	}
	vec4 bicubic( sampler2D tex, vec2 uv, vec4 texelSize, float lod ) {
		uv = uv * texelSize.zw + 0.5;
		vec2 iuv = floor( uv );
		vec2 fuv = fract( uv );
		float g0x = g0( fuv.x );
		float g1x = g1( fuv.x );
		float h0x = h0( fuv.x );
		float h1x = h1( fuv.x );
		float h0y = h0( fuv.y );
		float h1y = h1( fuv.y );
		vec2 p0 = ( vec2( iuv.x + h0x, iuv.y + h0y ) - 0.5 ) * texelSize.xy;
		vec2 p1 = ( vec2( iuv.x + h1x, iuv.y + h0y ) - 0.5 ) * texelSize.xy;
		vec2 p2 = ( vec2( iuv.x + h0x, iuv.y + h1y ) - 0.5 ) * texelSize.xy;
		vec2 p3 = ( vec2( iuv.x + h1x, iuv.y + h1y ) - 0.5 ) * texelSize.xy;
		return g0( fuv.y ) * ( g0x * textureLod( tex, p0, lod ) + g1x * textureLod( tex, p1, lod ) ) +
			g1( fuv.y ) * ( g0x * textureLod( tex, p2, lod ) + g1x * textureLod( tex, p3, lod ) );
	}
	vec4 textureBicubic( sampler2D sampler, vec2 uv, float lod ) {
		vec2 fLodSize = vec2( textureSize( sampler, int( lod ) ) );
		vec2 cLodSize = vec2( textureSize( sampler, int( lod + 1.0 ) ) );
		vec2 fLodSizeInv = 1.0 / fLodSize;
		vec2 cLodSizeInv = 1.0 / cLodSize;
		vec4 fSample = bicubic( sampler, uv, vec4( fLodSizeInv, fLodSize ), floor( lod ) );
		vec4 cSample = bicubic( sampler, uv, vec4( cLodSizeInv, cLodSize ), ceil( lod ) );
		return mix( fSample, cSample, fract( lod ) );
	}
	vec3 getVolumeTransmissionRay( const in vec3 n, const in vec3 v, const in float thickness, const in float ior, const in mat4 modelMatrix ) {
		vec3 refractionVector = refract( - v, normalize( n ), 1.0 / ior );
		vec3 modelScale;
		modelScale.x = length( vec3( modelMatrix[ 0 ].xyz ) );
		modelScale.y = length( vec3( modelMatrix[ 1 ].xyz ) );
		modelScale.z = length( vec3( modelMatrix[ 2 ].xyz ) );
		return normalize( refractionVector ) * thickness * modelScale;
	}
	float applyIorToRoughness( const in float roughness, const in float ior ) {
		return roughness * clamp( ior * 2.0 - 2.0, 0.0, 1.0 );
	}
	vec4 getTransmissionSample( const in vec2 fragCoord, const in float roughness, const in float ior ) {
		float lod = log2( transmissionSamplerSize.x ) * applyIorToRoughness( roughness, ior );
		return textureBicubic( transmissionSamplerMap, fragCoord.xy, lod );
	}
	vec3 volumeAttenuation( const in float transmissionDistance, const in vec3 attenuationColor, const in float attenuationDistance ) {
		if ( isinf( attenuationDistance ) ) {
			return vec3( 1.0 );
		} else {
			vec3 attenuationCoefficient = -log( attenuationColor ) / attenuationDistance;
			vec3 transmittance = exp( - attenuationCoefficient * transmissionDistance );			return transmittance;
		}
	}
	vec4 getIBLVolumeRefraction( const in vec3 n, const in vec3 v, const in float roughness, const in vec3 diffuseColor,
		const in vec3 specularColor, const in float specularF90, const in vec3 position, const in mat4 modelMatrix,
		const in mat4 viewMatrix, const in mat4 projMatrix, const in float dispersion, const in float ior, const in float thickness,
		const in vec3 attenuationColor, const in float attenuationDistance ) {
		vec4 transmittedLight;
		vec3 transmittance;
		#ifdef USE_DISPERSION
			float halfSpread = ( ior - 1.0 ) * 0.025 * dispersion;
			vec3 iors = vec3( ior - halfSpread, ior, ior + halfSpread );
			for ( int i = 0; i < 3; i ++ ) {
				vec3 transmissionRay = getVolumeTransmissionRay( n, v, thickness, iors[ i ], modelMatrix );
				vec3 refractedRayExit = position + transmissionRay;
				vec4 ndcPos = projMatrix * viewMatrix * vec4( refractedRayExit, 1.0 );
				vec2 refractionCoords = ndcPos.xy / ndcPos.w;
				refractionCoords += 1.0;
				refractionCoords /= 2.0;
				vec4 transmissionSample = getTransmissionSample( refractionCoords, roughness, iors[ i ] );
				transmittedLight[ i ] = transmissionSample[ i ];
				transmittedLight.a += transmissionSample.a;
				transmittance[ i ] = diffuseColor[ i ] * volumeAttenuation( length( transmissionRay ), attenuationColor, attenuationDistance )[ i ];
			}
			transmittedLight.a /= 3.0;
		#else
			vec3 transmissionRay = getVolumeTransmissionRay( n, v, thickness, ior, modelMatrix );
			vec3 refractedRayExit = position + transmissionRay;
			vec4 ndcPos = projMatrix * viewMatrix * vec4( refractedRayExit, 1.0 );
			vec2 refractionCoords = ndcPos.xy / ndcPos.w;
			refractionCoords += 1.0;
			refractionCoords /= 2.0;
			transmittedLight = getTransmissionSample( refractionCoords, roughness, ior );
			transmittance = diffuseColor * volumeAttenuation( length( transmissionRay ), attenuationColor, attenuationDistance );
		#endif
		vec3 attenuatedColor = transmittance * transmittedLight.rgb;
		vec3 F = EnvironmentBRDF( n, v, specularColor, specularF90, roughness );
		float transmittanceFactor = ( transmittance.r + transmittance.g + transmittance.b ) / 3.0;
		return vec4( ( 1.0 - F ) * attenuatedColor, 1.0 - ( 1.0 - transmittedLight.a ) * transmittanceFactor );
	}
#endif`,Nv=`#if defined( USE_UV ) || defined( USE_ANISOTROPY )
	varying vec2 vUv;
#endif
#ifdef USE_MAP
	varying vec2 vMapUv;
#endif
#ifdef USE_ALPHAMAP
	varying vec2 vAlphaMapUv;
#endif
#ifdef USE_LIGHTMAP
	varying vec2 vLightMapUv;
#endif
#ifdef USE_AOMAP
	varying vec2 vAoMapUv;
#endif
#ifdef USE_BUMPMAP
	varying vec2 vBumpMapUv;
#endif
#ifdef USE_NORMALMAP
	varying vec2 vNormalMapUv;
#endif
#ifdef USE_EMISSIVEMAP
	varying vec2 vEmissiveMapUv;
#endif
#ifdef USE_METALNESSMAP
	varying vec2 vMetalnessMapUv;
#endif
#ifdef USE_ROUGHNESSMAP
	varying vec2 vRoughnessMapUv;
#endif
#ifdef USE_DIFFUSE_ROUGHNESSMAP
	varying vec2 vDiffuseRoughnessMapUv;
#endif
#ifdef USE_ANISOTROPYMAP
	varying vec2 vAnisotropyMapUv;
#endif
#ifdef USE_CLEARCOATMAP
	varying vec2 vClearcoatMapUv;
#endif
#ifdef USE_CLEARCOAT_NORMALMAP
	varying vec2 vClearcoatNormalMapUv;
#endif
#ifdef USE_CLEARCOAT_ROUGHNESSMAP
	varying vec2 vClearcoatRoughnessMapUv;
#endif
#ifdef USE_IRIDESCENCEMAP
	varying vec2 vIridescenceMapUv;
#endif
#ifdef USE_IRIDESCENCE_THICKNESSMAP
	varying vec2 vIridescenceThicknessMapUv;
#endif
#ifdef USE_SHEEN_COLORMAP
	varying vec2 vSheenColorMapUv;
#endif
#ifdef USE_SHEEN_ROUGHNESSMAP
	varying vec2 vSheenRoughnessMapUv;
#endif
#ifdef USE_SPECULARMAP
	varying vec2 vSpecularMapUv;
#endif
#ifdef USE_SPECULAR_COLORMAP
	varying vec2 vSpecularColorMapUv;
#endif
#ifdef USE_SPECULAR_INTENSITYMAP
	varying vec2 vSpecularIntensityMapUv;
#endif
#ifdef USE_TRANSMISSIONMAP
	uniform mat3 transmissionMapTransform;
	varying vec2 vTransmissionMapUv;
#endif
#ifdef USE_THICKNESSMAP
	uniform mat3 thicknessMapTransform;
	varying vec2 vThicknessMapUv;
#endif`,Uv=`#if defined( USE_UV ) || defined( USE_ANISOTROPY )
	varying vec2 vUv;
#endif
#ifdef USE_MAP
	uniform mat3 mapTransform;
	varying vec2 vMapUv;
#endif
#ifdef USE_ALPHAMAP
	uniform mat3 alphaMapTransform;
	varying vec2 vAlphaMapUv;
#endif
#ifdef USE_LIGHTMAP
	uniform mat3 lightMapTransform;
	varying vec2 vLightMapUv;
#endif
#ifdef USE_AOMAP
	uniform mat3 aoMapTransform;
	varying vec2 vAoMapUv;
#endif
#ifdef USE_BUMPMAP
	uniform mat3 bumpMapTransform;
	varying vec2 vBumpMapUv;
#endif
#ifdef USE_NORMALMAP
	uniform mat3 normalMapTransform;
	varying vec2 vNormalMapUv;
#endif
#ifdef USE_DISPLACEMENTMAP
	uniform mat3 displacementMapTransform;
	varying vec2 vDisplacementMapUv;
#endif
#ifdef USE_EMISSIVEMAP
	uniform mat3 emissiveMapTransform;
	varying vec2 vEmissiveMapUv;
#endif
#ifdef USE_METALNESSMAP
	uniform mat3 metalnessMapTransform;
	varying vec2 vMetalnessMapUv;
#endif
#ifdef USE_ROUGHNESSMAP
	uniform mat3 roughnessMapTransform;
	varying vec2 vRoughnessMapUv;
#endif
#ifdef USE_DIFFUSE_ROUGHNESSMAP
	uniform mat3 diffuseRoughnessMapTransform;
	varying vec2 vDiffuseRoughnessMapUv;
#endif
#ifdef USE_ANISOTROPYMAP
	uniform mat3 anisotropyMapTransform;
	varying vec2 vAnisotropyMapUv;
#endif
#ifdef USE_CLEARCOATMAP
	uniform mat3 clearcoatMapTransform;
	varying vec2 vClearcoatMapUv;
#endif
#ifdef USE_CLEARCOAT_NORMALMAP
	uniform mat3 clearcoatNormalMapTransform;
	varying vec2 vClearcoatNormalMapUv;
#endif
#ifdef USE_CLEARCOAT_ROUGHNESSMAP
	uniform mat3 clearcoatRoughnessMapTransform;
	varying vec2 vClearcoatRoughnessMapUv;
#endif
#ifdef USE_SHEEN_COLORMAP
	uniform mat3 sheenColorMapTransform;
	varying vec2 vSheenColorMapUv;
#endif
#ifdef USE_SHEEN_ROUGHNESSMAP
	uniform mat3 sheenRoughnessMapTransform;
	varying vec2 vSheenRoughnessMapUv;
#endif
#ifdef USE_IRIDESCENCEMAP
	uniform mat3 iridescenceMapTransform;
	varying vec2 vIridescenceMapUv;
#endif
#ifdef USE_IRIDESCENCE_THICKNESSMAP
	uniform mat3 iridescenceThicknessMapTransform;
	varying vec2 vIridescenceThicknessMapUv;
#endif
#ifdef USE_SPECULARMAP
	uniform mat3 specularMapTransform;
	varying vec2 vSpecularMapUv;
#endif
#ifdef USE_SPECULAR_COLORMAP
	uniform mat3 specularColorMapTransform;
	varying vec2 vSpecularColorMapUv;
#endif
#ifdef USE_SPECULAR_INTENSITYMAP
	uniform mat3 specularIntensityMapTransform;
	varying vec2 vSpecularIntensityMapUv;
#endif
#ifdef USE_TRANSMISSIONMAP
	uniform mat3 transmissionMapTransform;
	varying vec2 vTransmissionMapUv;
#endif
#ifdef USE_THICKNESSMAP
	uniform mat3 thicknessMapTransform;
	varying vec2 vThicknessMapUv;
#endif`,Ov=`#if defined( USE_UV ) || defined( USE_ANISOTROPY )
	vUv = vec3( uv, 1 ).xy;
#endif
#ifdef USE_MAP
	vMapUv = ( mapTransform * vec3( MAP_UV, 1 ) ).xy;
#endif
#ifdef USE_ALPHAMAP
	vAlphaMapUv = ( alphaMapTransform * vec3( ALPHAMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_LIGHTMAP
	vLightMapUv = ( lightMapTransform * vec3( LIGHTMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_AOMAP
	vAoMapUv = ( aoMapTransform * vec3( AOMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_BUMPMAP
	vBumpMapUv = ( bumpMapTransform * vec3( BUMPMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_NORMALMAP
	vNormalMapUv = ( normalMapTransform * vec3( NORMALMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_DISPLACEMENTMAP
	vDisplacementMapUv = ( displacementMapTransform * vec3( DISPLACEMENTMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_EMISSIVEMAP
	vEmissiveMapUv = ( emissiveMapTransform * vec3( EMISSIVEMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_METALNESSMAP
	vMetalnessMapUv = ( metalnessMapTransform * vec3( METALNESSMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_ROUGHNESSMAP
	vRoughnessMapUv = ( roughnessMapTransform * vec3( ROUGHNESSMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_DIFFUSE_ROUGHNESSMAP
	vDiffuseRoughnessMapUv = ( diffuseRoughnessMapTransform * vec3( DIFFUSE_ROUGHNESSMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_ANISOTROPYMAP
	vAnisotropyMapUv = ( anisotropyMapTransform * vec3( ANISOTROPYMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_CLEARCOATMAP
	vClearcoatMapUv = ( clearcoatMapTransform * vec3( CLEARCOATMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_CLEARCOAT_NORMALMAP
	vClearcoatNormalMapUv = ( clearcoatNormalMapTransform * vec3( CLEARCOAT_NORMALMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_CLEARCOAT_ROUGHNESSMAP
	vClearcoatRoughnessMapUv = ( clearcoatRoughnessMapTransform * vec3( CLEARCOAT_ROUGHNESSMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_IRIDESCENCEMAP
	vIridescenceMapUv = ( iridescenceMapTransform * vec3( IRIDESCENCEMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_IRIDESCENCE_THICKNESSMAP
	vIridescenceThicknessMapUv = ( iridescenceThicknessMapTransform * vec3( IRIDESCENCE_THICKNESSMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_SHEEN_COLORMAP
	vSheenColorMapUv = ( sheenColorMapTransform * vec3( SHEEN_COLORMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_SHEEN_ROUGHNESSMAP
	vSheenRoughnessMapUv = ( sheenRoughnessMapTransform * vec3( SHEEN_ROUGHNESSMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_SPECULARMAP
	vSpecularMapUv = ( specularMapTransform * vec3( SPECULARMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_SPECULAR_COLORMAP
	vSpecularColorMapUv = ( specularColorMapTransform * vec3( SPECULAR_COLORMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_SPECULAR_INTENSITYMAP
	vSpecularIntensityMapUv = ( specularIntensityMapTransform * vec3( SPECULAR_INTENSITYMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_TRANSMISSIONMAP
	vTransmissionMapUv = ( transmissionMapTransform * vec3( TRANSMISSIONMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_THICKNESSMAP
	vThicknessMapUv = ( thicknessMapTransform * vec3( THICKNESSMAP_UV, 1 ) ).xy;
#endif`,Fv=`#if defined( USE_ENVMAP ) || defined( DISTANCE ) || defined ( USE_SHADOWMAP ) || defined ( USE_TRANSMISSION ) || NUM_SPOT_LIGHT_COORDS > 0
	vec4 worldPosition = vec4( transformed, 1.0 );
	#ifdef USE_BATCHING
		worldPosition = batchingMatrix * worldPosition;
	#endif
	#ifdef USE_INSTANCING
		worldPosition = instanceMatrix * worldPosition;
	#endif
	worldPosition = modelMatrix * worldPosition;
#endif`,Bv=`varying vec2 vUv;
uniform mat3 uvTransform;
void main() {
	vUv = ( uvTransform * vec3( uv, 1 ) ).xy;
	gl_Position = vec4( position.xy, 1.0, 1.0 );
}`,kv=`uniform sampler2D t2D;
uniform float backgroundIntensity;
varying vec2 vUv;
void main() {
	vec4 texColor = texture2D( t2D, vUv );
	#ifdef DECODE_VIDEO_TEXTURE
		texColor = vec4( mix( pow( texColor.rgb * 0.9478672986 + vec3( 0.0521327014 ), vec3( 2.4 ) ), texColor.rgb * 0.0773993808, vec3( lessThanEqual( texColor.rgb, vec3( 0.04045 ) ) ) ), texColor.w );
	#endif
	texColor.rgb *= backgroundIntensity;
	gl_FragColor = texColor;
	#include <tonemapping_fragment>
	#include <colorspace_fragment>
}`,zv=`varying vec3 vWorldDirection;
#include <common>
void main() {
	vWorldDirection = transformDirection( position, modelMatrix );
	#include <begin_vertex>
	#include <project_vertex>
	gl_Position.z = gl_Position.w;
}`,Gv=`uniform float backgroundBlurriness;
uniform float backgroundIntensity;
uniform mat3 backgroundRotation;
varying vec3 vWorldDirection;
#include <envmap_common_pars_fragment>
void main() {
	#ifdef ENVMAP_TYPE_PMREM
		vec4 texColor = textureLod( envMap, backgroundRotation * vWorldDirection, roughnessToMip( backgroundBlurriness ) );
	#else
		vec4 texColor = textureCube( envMap, backgroundRotation * vWorldDirection );
	#endif
	texColor.rgb *= backgroundIntensity;
	gl_FragColor = texColor;
	#include <tonemapping_fragment>
	#include <colorspace_fragment>
}`,Vv=`varying vec3 vWorldDirection;
#include <common>
void main() {
	vWorldDirection = transformDirection( position, modelMatrix );
	#include <begin_vertex>
	#include <project_vertex>
	gl_Position.z = gl_Position.w;
}`,Hv=`uniform samplerCube tCube;
uniform float tFlip;
uniform float opacity;
varying vec3 vWorldDirection;
void main() {
	vec4 texColor = textureCube( tCube, vec3( tFlip * vWorldDirection.x, vWorldDirection.yz ) );
	gl_FragColor = texColor;
	gl_FragColor.a *= opacity;
	#include <tonemapping_fragment>
	#include <colorspace_fragment>
}`,Wv=`#include <common>
#include <batching_pars_vertex>
#include <uv_pars_vertex>
#include <displacementmap_pars_vertex>
#include <morphtarget_pars_vertex>
#include <skinning_pars_vertex>
#include <logdepthbuf_pars_vertex>
#include <clipping_planes_pars_vertex>
varying vec2 vHighPrecisionZW;
void main() {
	#include <uv_vertex>
	#include <batching_vertex>
	#include <skinbase_vertex>
	#include <morphinstance_vertex>
	#ifdef USE_DISPLACEMENTMAP
		#include <beginnormal_vertex>
		#include <morphnormal_vertex>
		#include <skinnormal_vertex>
	#endif
	#include <begin_vertex>
	#include <morphtarget_vertex>
	#include <skinning_vertex>
	#include <displacementmap_vertex>
	#include <project_vertex>
	#include <logdepthbuf_vertex>
	#include <clipping_planes_vertex>
	vHighPrecisionZW = gl_Position.zw;
}`,Xv=`#if DEPTH_PACKING == 3200
	uniform float opacity;
#endif
#include <common>
#include <packing>
#include <uv_pars_fragment>
#include <map_pars_fragment>
#include <alphamap_pars_fragment>
#include <alphatest_pars_fragment>
#include <alphahash_pars_fragment>
#include <logdepthbuf_pars_fragment>
#include <clipping_planes_pars_fragment>
varying vec2 vHighPrecisionZW;
void main() {
	vec4 diffuseColor = vec4( 1.0 );
	#include <clipping_planes_fragment>
	#if DEPTH_PACKING == 3200
		diffuseColor.a = opacity;
	#endif
	#include <map_fragment>
	#include <alphamap_fragment>
	#include <alphatest_fragment>
	#include <alphahash_fragment>
	#include <logdepthbuf_fragment>
	#ifdef USE_REVERSED_DEPTH_BUFFER
		float fragCoordZ = vHighPrecisionZW[ 0 ] / vHighPrecisionZW[ 1 ];
	#else
		float fragCoordZ = 0.5 * vHighPrecisionZW[ 0 ] / vHighPrecisionZW[ 1 ] + 0.5;
	#endif
	#if DEPTH_PACKING == 3200
		gl_FragColor = vec4( vec3( 1.0 - fragCoordZ ), opacity );
	#elif DEPTH_PACKING == 3201
		gl_FragColor = packDepthToRGBA( fragCoordZ );
	#elif DEPTH_PACKING == 3202
		gl_FragColor = vec4( packDepthToRGB( fragCoordZ ), 1.0 );
	#elif DEPTH_PACKING == 3203
		gl_FragColor = vec4( packDepthToRG( fragCoordZ ), 0.0, 1.0 );
	#endif
}`,qv=`#define DISTANCE
varying vec3 vWorldPosition;
#include <common>
#include <batching_pars_vertex>
#include <uv_pars_vertex>
#include <displacementmap_pars_vertex>
#include <morphtarget_pars_vertex>
#include <skinning_pars_vertex>
#include <clipping_planes_pars_vertex>
void main() {
	#include <uv_vertex>
	#include <batching_vertex>
	#include <skinbase_vertex>
	#include <morphinstance_vertex>
	#ifdef USE_DISPLACEMENTMAP
		#include <beginnormal_vertex>
		#include <morphnormal_vertex>
		#include <skinnormal_vertex>
	#endif
	#include <begin_vertex>
	#include <morphtarget_vertex>
	#include <skinning_vertex>
	#include <displacementmap_vertex>
	#include <project_vertex>
	#include <worldpos_vertex>
	#include <clipping_planes_vertex>
	vWorldPosition = worldPosition.xyz;
}`,$v=`#define DISTANCE
uniform vec3 referencePosition;
uniform float nearDistance;
uniform float farDistance;
varying vec3 vWorldPosition;
#include <common>
#include <uv_pars_fragment>
#include <map_pars_fragment>
#include <alphamap_pars_fragment>
#include <alphatest_pars_fragment>
#include <alphahash_pars_fragment>
#include <clipping_planes_pars_fragment>
void main() {
	vec4 diffuseColor = vec4( 1.0 );
	#include <clipping_planes_fragment>
	#include <map_fragment>
	#include <alphamap_fragment>
	#include <alphatest_fragment>
	#include <alphahash_fragment>
	float dist = length( vWorldPosition - referencePosition );
	dist = ( dist - nearDistance ) / ( farDistance - nearDistance );
	dist = saturate( dist );
	gl_FragColor = vec4( dist, 0.0, 0.0, 1.0 );
}`,Yv=`varying vec3 vWorldDirection;
#include <common>
void main() {
	vWorldDirection = transformDirection( position, modelMatrix );
	#include <begin_vertex>
	#include <project_vertex>
}`,Zv=`uniform sampler2D tEquirect;
varying vec3 vWorldDirection;
#include <common>
void main() {
	vec3 direction = normalize( vWorldDirection );
	vec2 sampleUV = equirectUv( direction );
	gl_FragColor = texture2D( tEquirect, sampleUV );
	#include <tonemapping_fragment>
	#include <colorspace_fragment>
}`,Jv=`uniform float scale;
attribute float lineDistance;
varying float vLineDistance;
#include <common>
#include <uv_pars_vertex>
#include <color_pars_vertex>
#include <fog_pars_vertex>
#include <morphtarget_pars_vertex>
#include <logdepthbuf_pars_vertex>
#include <clipping_planes_pars_vertex>
void main() {
	vLineDistance = scale * lineDistance;
	#include <uv_vertex>
	#include <color_vertex>
	#include <morphinstance_vertex>
	#include <morphcolor_vertex>
	#include <begin_vertex>
	#include <morphtarget_vertex>
	#include <project_vertex>
	#include <logdepthbuf_vertex>
	#include <clipping_planes_vertex>
	#include <fog_vertex>
}`,jv=`uniform vec3 diffuse;
uniform float opacity;
uniform float dashSize;
uniform float totalSize;
varying float vLineDistance;
#include <common>
#include <color_pars_fragment>
#include <uv_pars_fragment>
#include <map_pars_fragment>
#include <fog_pars_fragment>
#include <logdepthbuf_pars_fragment>
#include <clipping_planes_pars_fragment>
void main() {
	vec4 diffuseColor = vec4( diffuse, opacity );
	#include <clipping_planes_fragment>
	if ( mod( vLineDistance, totalSize ) > dashSize ) {
		discard;
	}
	vec3 outgoingLight = vec3( 0.0 );
	#include <logdepthbuf_fragment>
	#include <map_fragment>
	#include <color_fragment>
	outgoingLight = diffuseColor.rgb;
	#include <opaque_fragment>
	#include <tonemapping_fragment>
	#include <colorspace_fragment>
	#include <fog_fragment>
	#include <premultiplied_alpha_fragment>
}`,Kv=`#include <common>
#include <batching_pars_vertex>
#include <uv_pars_vertex>
#include <envmap_pars_vertex>
#include <color_pars_vertex>
#include <fog_pars_vertex>
#include <morphtarget_pars_vertex>
#include <skinning_pars_vertex>
#include <logdepthbuf_pars_vertex>
#include <clipping_planes_pars_vertex>
void main() {
	#include <uv_vertex>
	#include <color_vertex>
	#include <morphinstance_vertex>
	#include <morphcolor_vertex>
	#include <batching_vertex>
	#if defined ( USE_ENVMAP ) || defined ( USE_SKINNING )
		#include <beginnormal_vertex>
		#include <morphnormal_vertex>
		#include <skinbase_vertex>
		#include <skinnormal_vertex>
		#include <defaultnormal_vertex>
	#endif
	#include <begin_vertex>
	#include <morphtarget_vertex>
	#include <skinning_vertex>
	#include <project_vertex>
	#include <logdepthbuf_vertex>
	#include <clipping_planes_vertex>
	#include <worldpos_vertex>
	#include <envmap_vertex>
	#include <fog_vertex>
}`,Qv=`uniform vec3 diffuse;
uniform float opacity;
#ifndef FLAT_SHADED
	varying vec3 vNormal;
#endif
#include <common>
#include <dithering_pars_fragment>
#include <color_pars_fragment>
#include <uv_pars_fragment>
#include <map_pars_fragment>
#include <alphamap_pars_fragment>
#include <alphatest_pars_fragment>
#include <alphahash_pars_fragment>
#include <aomap_pars_fragment>
#include <lightmap_pars_fragment>
#include <envmap_common_pars_fragment>
#include <envmap_pars_fragment>
#include <fog_pars_fragment>
#include <specularmap_pars_fragment>
#include <logdepthbuf_pars_fragment>
#include <clipping_planes_pars_fragment>
void main() {
	vec4 diffuseColor = vec4( diffuse, opacity );
	#include <clipping_planes_fragment>
	#include <logdepthbuf_fragment>
	#include <map_fragment>
	#include <color_fragment>
	#include <alphamap_fragment>
	#include <alphatest_fragment>
	#include <alphahash_fragment>
	#include <specularmap_fragment>
	ReflectedLight reflectedLight = ReflectedLight( vec3( 0.0 ), vec3( 0.0 ), vec3( 0.0 ), vec3( 0.0 ) );
	#ifdef USE_LIGHTMAP
		vec4 lightMapTexel = texture2D( lightMap, vLightMapUv );
		reflectedLight.indirectDiffuse += lightMapTexel.rgb * lightMapIntensity * RECIPROCAL_PI;
	#else
		reflectedLight.indirectDiffuse += vec3( 1.0 );
	#endif
	#include <aomap_fragment>
	reflectedLight.indirectDiffuse *= diffuseColor.rgb;
	vec3 outgoingLight = reflectedLight.indirectDiffuse;
	#include <envmap_fragment>
	#include <opaque_fragment>
	#include <tonemapping_fragment>
	#include <colorspace_fragment>
	#include <fog_fragment>
	#include <premultiplied_alpha_fragment>
	#include <dithering_fragment>
}`,ty=`#define LAMBERT
varying vec3 vViewPosition;
#include <common>
#include <batching_pars_vertex>
#include <uv_pars_vertex>
#include <displacementmap_pars_vertex>
#include <envmap_pars_vertex>
#include <color_pars_vertex>
#include <fog_pars_vertex>
#include <normal_pars_vertex>
#include <morphtarget_pars_vertex>
#include <skinning_pars_vertex>
#include <shadowmap_pars_vertex>
#include <logdepthbuf_pars_vertex>
#include <clipping_planes_pars_vertex>
void main() {
	#include <uv_vertex>
	#include <color_vertex>
	#include <morphinstance_vertex>
	#include <morphcolor_vertex>
	#include <batching_vertex>
	#include <beginnormal_vertex>
	#include <morphnormal_vertex>
	#include <skinbase_vertex>
	#include <skinnormal_vertex>
	#include <defaultnormal_vertex>
	#include <normal_vertex>
	#include <begin_vertex>
	#include <morphtarget_vertex>
	#include <skinning_vertex>
	#include <displacementmap_vertex>
	#include <project_vertex>
	#include <logdepthbuf_vertex>
	#include <clipping_planes_vertex>
	vViewPosition = - mvPosition.xyz;
	#include <worldpos_vertex>
	#include <envmap_vertex>
	#include <shadowmap_vertex>
	#include <fog_vertex>
}`,ey=`#define LAMBERT
uniform vec3 diffuse;
uniform vec3 emissive;
uniform float opacity;
#include <common>
#include <dithering_pars_fragment>
#include <color_pars_fragment>
#include <uv_pars_fragment>
#include <map_pars_fragment>
#include <alphamap_pars_fragment>
#include <alphatest_pars_fragment>
#include <alphahash_pars_fragment>
#include <aomap_pars_fragment>
#include <lightmap_pars_fragment>
#include <emissivemap_pars_fragment>
#include <envmap_common_pars_fragment>
#include <envmap_pars_fragment>
#include <envmap_physical_pars_fragment>
#include <fog_pars_fragment>
#include <bsdfs>
#include <lights_pars_begin>
#include <normal_pars_fragment>
#include <lights_lambert_pars_fragment>
#include <shadowmap_pars_fragment>
#include <bumpmap_pars_fragment>
#include <normalmap_pars_fragment>
#include <specularmap_pars_fragment>
#include <logdepthbuf_pars_fragment>
#include <clipping_planes_pars_fragment>
void main() {
	vec4 diffuseColor = vec4( diffuse, opacity );
	#include <clipping_planes_fragment>
	ReflectedLight reflectedLight = ReflectedLight( vec3( 0.0 ), vec3( 0.0 ), vec3( 0.0 ), vec3( 0.0 ) );
	vec3 totalEmissiveRadiance = emissive;
	#include <logdepthbuf_fragment>
	#include <map_fragment>
	#include <color_fragment>
	#include <alphamap_fragment>
	#include <alphatest_fragment>
	#include <alphahash_fragment>
	#include <specularmap_fragment>
	#include <normal_fragment_begin>
	#include <normal_fragment_maps>
	#include <emissivemap_fragment>
	#include <lights_lambert_fragment>
	#include <lights_fragment_begin>
	#include <lights_fragment_maps>
	#include <lights_fragment_end>
	#include <aomap_fragment>
	vec3 outgoingLight = reflectedLight.directDiffuse + reflectedLight.indirectDiffuse + totalEmissiveRadiance;
	#include <envmap_fragment>
	#include <opaque_fragment>
	#include <tonemapping_fragment>
	#include <colorspace_fragment>
	#include <fog_fragment>
	#include <premultiplied_alpha_fragment>
	#include <dithering_fragment>
}`,ny=`#define MATCAP
varying vec3 vViewPosition;
#include <common>
#include <batching_pars_vertex>
#include <uv_pars_vertex>
#include <color_pars_vertex>
#include <displacementmap_pars_vertex>
#include <fog_pars_vertex>
#include <normal_pars_vertex>
#include <morphtarget_pars_vertex>
#include <skinning_pars_vertex>
#include <logdepthbuf_pars_vertex>
#include <clipping_planes_pars_vertex>
void main() {
	#include <uv_vertex>
	#include <color_vertex>
	#include <morphinstance_vertex>
	#include <morphcolor_vertex>
	#include <batching_vertex>
	#include <beginnormal_vertex>
	#include <morphnormal_vertex>
	#include <skinbase_vertex>
	#include <skinnormal_vertex>
	#include <defaultnormal_vertex>
	#include <normal_vertex>
	#include <begin_vertex>
	#include <morphtarget_vertex>
	#include <skinning_vertex>
	#include <displacementmap_vertex>
	#include <project_vertex>
	#include <logdepthbuf_vertex>
	#include <clipping_planes_vertex>
	#include <fog_vertex>
	vViewPosition = - mvPosition.xyz;
}`,iy=`#define MATCAP
uniform vec3 diffuse;
uniform float opacity;
uniform sampler2D matcap;
varying vec3 vViewPosition;
#include <common>
#include <dithering_pars_fragment>
#include <color_pars_fragment>
#include <uv_pars_fragment>
#include <map_pars_fragment>
#include <alphamap_pars_fragment>
#include <alphatest_pars_fragment>
#include <alphahash_pars_fragment>
#include <fog_pars_fragment>
#include <normal_pars_fragment>
#include <bumpmap_pars_fragment>
#include <normalmap_pars_fragment>
#include <logdepthbuf_pars_fragment>
#include <clipping_planes_pars_fragment>
void main() {
	vec4 diffuseColor = vec4( diffuse, opacity );
	#include <clipping_planes_fragment>
	#include <logdepthbuf_fragment>
	#include <map_fragment>
	#include <color_fragment>
	#include <alphamap_fragment>
	#include <alphatest_fragment>
	#include <alphahash_fragment>
	#include <normal_fragment_begin>
	#include <normal_fragment_maps>
	vec3 viewDir = normalize( vViewPosition );
	vec3 x = normalize( vec3( viewDir.z, 0.0, - viewDir.x ) );
	vec3 y = cross( viewDir, x );
	vec2 uv = vec2( dot( x, normal ), dot( y, normal ) ) * 0.495 + 0.5;
	#ifdef USE_MATCAP
		vec4 matcapColor = texture2D( matcap, uv );
	#else
		vec4 matcapColor = vec4( vec3( mix( 0.2, 0.8, uv.y ) ), 1.0 );
	#endif
	vec3 outgoingLight = diffuseColor.rgb * matcapColor.rgb;
	#include <opaque_fragment>
	#include <tonemapping_fragment>
	#include <colorspace_fragment>
	#include <fog_fragment>
	#include <premultiplied_alpha_fragment>
	#include <dithering_fragment>
}`,sy=`#define NORMAL
#if defined( FLAT_SHADED ) || defined( USE_BUMPMAP ) || defined( USE_NORMALMAP_TANGENTSPACE )
	varying vec3 vViewPosition;
#endif
#include <common>
#include <batching_pars_vertex>
#include <uv_pars_vertex>
#include <displacementmap_pars_vertex>
#include <normal_pars_vertex>
#include <morphtarget_pars_vertex>
#include <skinning_pars_vertex>
#include <logdepthbuf_pars_vertex>
#include <clipping_planes_pars_vertex>
void main() {
	#include <uv_vertex>
	#include <batching_vertex>
	#include <beginnormal_vertex>
	#include <morphinstance_vertex>
	#include <morphnormal_vertex>
	#include <skinbase_vertex>
	#include <skinnormal_vertex>
	#include <defaultnormal_vertex>
	#include <normal_vertex>
	#include <begin_vertex>
	#include <morphtarget_vertex>
	#include <skinning_vertex>
	#include <displacementmap_vertex>
	#include <project_vertex>
	#include <logdepthbuf_vertex>
	#include <clipping_planes_vertex>
#if defined( FLAT_SHADED ) || defined( USE_BUMPMAP ) || defined( USE_NORMALMAP_TANGENTSPACE )
	vViewPosition = - mvPosition.xyz;
#endif
}`,ry=`#define NORMAL
uniform float opacity;
#if defined( FLAT_SHADED ) || defined( USE_BUMPMAP ) || defined( USE_NORMALMAP_TANGENTSPACE )
	varying vec3 vViewPosition;
#endif
#include <uv_pars_fragment>
#include <normal_pars_fragment>
#include <bumpmap_pars_fragment>
#include <normalmap_pars_fragment>
#include <logdepthbuf_pars_fragment>
#include <clipping_planes_pars_fragment>
void main() {
	vec4 diffuseColor = vec4( 0.0, 0.0, 0.0, opacity );
	#include <clipping_planes_fragment>
	#include <logdepthbuf_fragment>
	#include <normal_fragment_begin>
	#include <normal_fragment_maps>
	gl_FragColor = vec4( normalize( normal ) * 0.5 + 0.5, diffuseColor.a );
	#ifdef OPAQUE
		gl_FragColor.a = 1.0;
	#endif
}`,oy=`#define PHONG
varying vec3 vViewPosition;
#include <common>
#include <batching_pars_vertex>
#include <uv_pars_vertex>
#include <displacementmap_pars_vertex>
#include <envmap_pars_vertex>
#include <color_pars_vertex>
#include <fog_pars_vertex>
#include <normal_pars_vertex>
#include <morphtarget_pars_vertex>
#include <skinning_pars_vertex>
#include <shadowmap_pars_vertex>
#include <logdepthbuf_pars_vertex>
#include <clipping_planes_pars_vertex>
void main() {
	#include <uv_vertex>
	#include <color_vertex>
	#include <morphcolor_vertex>
	#include <batching_vertex>
	#include <beginnormal_vertex>
	#include <morphinstance_vertex>
	#include <morphnormal_vertex>
	#include <skinbase_vertex>
	#include <skinnormal_vertex>
	#include <defaultnormal_vertex>
	#include <normal_vertex>
	#include <begin_vertex>
	#include <morphtarget_vertex>
	#include <skinning_vertex>
	#include <displacementmap_vertex>
	#include <project_vertex>
	#include <logdepthbuf_vertex>
	#include <clipping_planes_vertex>
	vViewPosition = - mvPosition.xyz;
	#include <worldpos_vertex>
	#include <envmap_vertex>
	#include <shadowmap_vertex>
	#include <fog_vertex>
}`,ay=`#define PHONG
uniform vec3 diffuse;
uniform vec3 emissive;
uniform vec3 specular;
uniform float shininess;
uniform float opacity;
#include <common>
#include <dithering_pars_fragment>
#include <color_pars_fragment>
#include <uv_pars_fragment>
#include <map_pars_fragment>
#include <alphamap_pars_fragment>
#include <alphatest_pars_fragment>
#include <alphahash_pars_fragment>
#include <aomap_pars_fragment>
#include <lightmap_pars_fragment>
#include <emissivemap_pars_fragment>
#include <envmap_common_pars_fragment>
#include <envmap_pars_fragment>
#include <envmap_physical_pars_fragment>
#include <fog_pars_fragment>
#include <bsdfs>
#include <lights_pars_begin>
#include <normal_pars_fragment>
#include <lights_phong_pars_fragment>
#include <shadowmap_pars_fragment>
#include <bumpmap_pars_fragment>
#include <normalmap_pars_fragment>
#include <specularmap_pars_fragment>
#include <logdepthbuf_pars_fragment>
#include <clipping_planes_pars_fragment>
void main() {
	vec4 diffuseColor = vec4( diffuse, opacity );
	#include <clipping_planes_fragment>
	ReflectedLight reflectedLight = ReflectedLight( vec3( 0.0 ), vec3( 0.0 ), vec3( 0.0 ), vec3( 0.0 ) );
	vec3 totalEmissiveRadiance = emissive;
	#include <logdepthbuf_fragment>
	#include <map_fragment>
	#include <color_fragment>
	#include <alphamap_fragment>
	#include <alphatest_fragment>
	#include <alphahash_fragment>
	#include <specularmap_fragment>
	#include <normal_fragment_begin>
	#include <normal_fragment_maps>
	#include <emissivemap_fragment>
	#include <lights_phong_fragment>
	#include <lights_fragment_begin>
	#include <lights_fragment_maps>
	#include <lights_fragment_end>
	#include <aomap_fragment>
	vec3 outgoingLight = reflectedLight.directDiffuse + reflectedLight.indirectDiffuse + reflectedLight.directSpecular + reflectedLight.indirectSpecular + totalEmissiveRadiance;
	#include <envmap_fragment>
	#include <opaque_fragment>
	#include <tonemapping_fragment>
	#include <colorspace_fragment>
	#include <fog_fragment>
	#include <premultiplied_alpha_fragment>
	#include <dithering_fragment>
}`,ly=`#define STANDARD
varying vec3 vViewPosition;
#ifdef USE_TRANSMISSION
	varying vec3 vWorldPosition;
#endif
#include <common>
#include <batching_pars_vertex>
#include <uv_pars_vertex>
#include <displacementmap_pars_vertex>
#include <color_pars_vertex>
#include <fog_pars_vertex>
#include <normal_pars_vertex>
#include <morphtarget_pars_vertex>
#include <skinning_pars_vertex>
#include <shadowmap_pars_vertex>
#include <logdepthbuf_pars_vertex>
#include <clipping_planes_pars_vertex>
void main() {
	#include <uv_vertex>
	#include <color_vertex>
	#include <morphinstance_vertex>
	#include <morphcolor_vertex>
	#include <batching_vertex>
	#include <beginnormal_vertex>
	#include <morphnormal_vertex>
	#include <skinbase_vertex>
	#include <skinnormal_vertex>
	#include <defaultnormal_vertex>
	#include <normal_vertex>
	#include <begin_vertex>
	#include <morphtarget_vertex>
	#include <skinning_vertex>
	#include <displacementmap_vertex>
	#include <project_vertex>
	#include <logdepthbuf_vertex>
	#include <clipping_planes_vertex>
	vViewPosition = - mvPosition.xyz;
	#include <worldpos_vertex>
	#include <shadowmap_vertex>
	#include <fog_vertex>
#ifdef USE_TRANSMISSION
	vWorldPosition = worldPosition.xyz;
#endif
}`,cy=`#define STANDARD
#ifdef PHYSICAL
	#define IOR
	#define USE_SPECULAR
#endif
uniform vec3 diffuse;
uniform vec3 emissive;
uniform float roughness;
uniform float metalness;
uniform float opacity;
#ifdef IOR
	uniform float ior;
#endif
#ifdef USE_SPECULAR
	uniform float specularIntensity;
	uniform vec3 specularColor;
	#ifdef USE_SPECULAR_COLORMAP
		uniform sampler2D specularColorMap;
	#endif
	#ifdef USE_SPECULAR_INTENSITYMAP
		uniform sampler2D specularIntensityMap;
	#endif
#endif
#ifdef USE_CLEARCOAT
	uniform float clearcoat;
	uniform float clearcoatRoughness;
#endif
#ifdef USE_DIFFUSE_ROUGHNESS
	uniform float diffuseRoughness;
	#ifdef USE_DIFFUSE_ROUGHNESSMAP
		uniform sampler2D diffuseRoughnessMap;
	#endif
#endif
#ifdef USE_DISPERSION
	uniform float dispersion;
#endif
#ifdef USE_RETROREFLECTION
	uniform float retroreflectivity;
#endif
#ifdef USE_IRIDESCENCE
	uniform float iridescence;
	uniform float iridescenceIOR;
	uniform float iridescenceThicknessMinimum;
	uniform float iridescenceThicknessMaximum;
#endif
#ifdef USE_SHEEN
	uniform vec3 sheenColor;
	uniform float sheenRoughness;
	#ifdef USE_SHEEN_COLORMAP
		uniform sampler2D sheenColorMap;
	#endif
	#ifdef USE_SHEEN_ROUGHNESSMAP
		uniform sampler2D sheenRoughnessMap;
	#endif
#endif
#ifdef USE_ANISOTROPY
	uniform vec2 anisotropyVector;
	#ifdef USE_ANISOTROPYMAP
		uniform sampler2D anisotropyMap;
	#endif
#endif
varying vec3 vViewPosition;
#include <common>
#include <dithering_pars_fragment>
#include <color_pars_fragment>
#include <uv_pars_fragment>
#include <map_pars_fragment>
#include <alphamap_pars_fragment>
#include <alphatest_pars_fragment>
#include <alphahash_pars_fragment>
#include <aomap_pars_fragment>
#include <lightmap_pars_fragment>
#include <emissivemap_pars_fragment>
#include <iridescence_fragment>
#include <envmap_common_pars_fragment>
#include <envmap_physical_pars_fragment>
#include <fog_pars_fragment>
#include <lights_pars_begin>
#include <normal_pars_fragment>
#include <lights_physical_pars_fragment>
#include <transmission_pars_fragment>
#include <shadowmap_pars_fragment>
#include <bumpmap_pars_fragment>
#include <normalmap_pars_fragment>
#include <clearcoat_pars_fragment>
#include <iridescence_pars_fragment>
#include <roughnessmap_pars_fragment>
#include <metalnessmap_pars_fragment>
#include <logdepthbuf_pars_fragment>
#include <clipping_planes_pars_fragment>
void main() {
	vec4 diffuseColor = vec4( diffuse, opacity );
	#include <clipping_planes_fragment>
	ReflectedLight reflectedLight = ReflectedLight( vec3( 0.0 ), vec3( 0.0 ), vec3( 0.0 ), vec3( 0.0 ) );
	vec3 totalEmissiveRadiance = emissive;
	#include <logdepthbuf_fragment>
	#include <map_fragment>
	#include <color_fragment>
	#include <alphamap_fragment>
	#include <alphatest_fragment>
	#include <alphahash_fragment>
	#include <roughnessmap_fragment>
	#include <metalnessmap_fragment>
	#include <normal_fragment_begin>
	#include <normal_fragment_maps>
	#include <clearcoat_normal_fragment_begin>
	#include <clearcoat_normal_fragment_maps>
	#include <emissivemap_fragment>
	#include <lights_physical_fragment>
	#include <lights_fragment_begin>
	#include <lights_fragment_maps>
	#include <lights_fragment_end>
	#include <aomap_fragment>
	vec3 totalDiffuse = reflectedLight.directDiffuse + reflectedLight.indirectDiffuse;
	vec3 totalSpecular = reflectedLight.directSpecular + reflectedLight.indirectSpecular;
	#include <transmission_fragment>
	vec3 outgoingLight = totalDiffuse + totalSpecular + totalEmissiveRadiance;
	#ifdef USE_SHEEN
 
		outgoingLight = outgoingLight + sheenSpecularDirect + sheenSpecularIndirect;
 
 	#endif
	#ifdef USE_CLEARCOAT
		float dotNVcc = saturate( dot( geometryClearcoatNormal, geometryViewDir ) );
		vec3 Fcc = F_Schlick( material.clearcoatF0, material.clearcoatF90, dotNVcc );
		outgoingLight = outgoingLight * ( 1.0 - material.clearcoat * Fcc ) + ( clearcoatSpecularDirect + clearcoatSpecularIndirect ) * material.clearcoat;
	#endif
	#include <opaque_fragment>
	#include <tonemapping_fragment>
	#include <colorspace_fragment>
	#include <fog_fragment>
	#include <premultiplied_alpha_fragment>
	#include <dithering_fragment>
}`,hy=`#define TOON
varying vec3 vViewPosition;
#include <common>
#include <batching_pars_vertex>
#include <uv_pars_vertex>
#include <displacementmap_pars_vertex>
#include <color_pars_vertex>
#include <fog_pars_vertex>
#include <normal_pars_vertex>
#include <morphtarget_pars_vertex>
#include <skinning_pars_vertex>
#include <shadowmap_pars_vertex>
#include <logdepthbuf_pars_vertex>
#include <clipping_planes_pars_vertex>
void main() {
	#include <uv_vertex>
	#include <color_vertex>
	#include <morphinstance_vertex>
	#include <morphcolor_vertex>
	#include <batching_vertex>
	#include <beginnormal_vertex>
	#include <morphnormal_vertex>
	#include <skinbase_vertex>
	#include <skinnormal_vertex>
	#include <defaultnormal_vertex>
	#include <normal_vertex>
	#include <begin_vertex>
	#include <morphtarget_vertex>
	#include <skinning_vertex>
	#include <displacementmap_vertex>
	#include <project_vertex>
	#include <logdepthbuf_vertex>
	#include <clipping_planes_vertex>
	vViewPosition = - mvPosition.xyz;
	#include <worldpos_vertex>
	#include <shadowmap_vertex>
	#include <fog_vertex>
}`,uy=`#define TOON
uniform vec3 diffuse;
uniform vec3 emissive;
uniform float opacity;
#include <common>
#include <dithering_pars_fragment>
#include <color_pars_fragment>
#include <uv_pars_fragment>
#include <map_pars_fragment>
#include <alphamap_pars_fragment>
#include <alphatest_pars_fragment>
#include <alphahash_pars_fragment>
#include <aomap_pars_fragment>
#include <lightmap_pars_fragment>
#include <emissivemap_pars_fragment>
#include <gradientmap_pars_fragment>
#include <fog_pars_fragment>
#include <bsdfs>
#include <lights_pars_begin>
#include <normal_pars_fragment>
#include <lights_toon_pars_fragment>
#include <shadowmap_pars_fragment>
#include <bumpmap_pars_fragment>
#include <normalmap_pars_fragment>
#include <logdepthbuf_pars_fragment>
#include <clipping_planes_pars_fragment>
void main() {
	vec4 diffuseColor = vec4( diffuse, opacity );
	#include <clipping_planes_fragment>
	ReflectedLight reflectedLight = ReflectedLight( vec3( 0.0 ), vec3( 0.0 ), vec3( 0.0 ), vec3( 0.0 ) );
	vec3 totalEmissiveRadiance = emissive;
	#include <logdepthbuf_fragment>
	#include <map_fragment>
	#include <color_fragment>
	#include <alphamap_fragment>
	#include <alphatest_fragment>
	#include <alphahash_fragment>
	#include <normal_fragment_begin>
	#include <normal_fragment_maps>
	#include <emissivemap_fragment>
	#include <lights_toon_fragment>
	#include <lights_fragment_begin>
	#include <lights_fragment_maps>
	#include <lights_fragment_end>
	#include <aomap_fragment>
	vec3 outgoingLight = reflectedLight.directDiffuse + reflectedLight.indirectDiffuse + totalEmissiveRadiance;
	#include <opaque_fragment>
	#include <tonemapping_fragment>
	#include <colorspace_fragment>
	#include <fog_fragment>
	#include <premultiplied_alpha_fragment>
	#include <dithering_fragment>
}`,dy=`uniform float size;
uniform float scale;
#include <common>
#include <color_pars_vertex>
#include <fog_pars_vertex>
#include <morphtarget_pars_vertex>
#include <logdepthbuf_pars_vertex>
#include <clipping_planes_pars_vertex>
#ifdef USE_POINTS_UV
	varying vec2 vUv;
	uniform mat3 uvTransform;
#endif
void main() {
	#ifdef USE_POINTS_UV
		vUv = ( uvTransform * vec3( uv, 1 ) ).xy;
	#endif
	#include <color_vertex>
	#include <morphinstance_vertex>
	#include <morphcolor_vertex>
	#include <begin_vertex>
	#include <morphtarget_vertex>
	#include <project_vertex>
	gl_PointSize = size;
	#ifdef USE_SIZEATTENUATION
		bool isPerspective = isPerspectiveMatrix( projectionMatrix );
		if ( isPerspective ) gl_PointSize *= ( scale / - mvPosition.z );
	#endif
	#include <logdepthbuf_vertex>
	#include <clipping_planes_vertex>
	#include <worldpos_vertex>
	#include <fog_vertex>
}`,fy=`uniform vec3 diffuse;
uniform float opacity;
#include <common>
#include <color_pars_fragment>
#include <map_particle_pars_fragment>
#include <alphatest_pars_fragment>
#include <alphahash_pars_fragment>
#include <fog_pars_fragment>
#include <logdepthbuf_pars_fragment>
#include <clipping_planes_pars_fragment>
void main() {
	vec4 diffuseColor = vec4( diffuse, opacity );
	#include <clipping_planes_fragment>
	vec3 outgoingLight = vec3( 0.0 );
	#include <logdepthbuf_fragment>
	#include <map_particle_fragment>
	#include <color_fragment>
	#include <alphatest_fragment>
	#include <alphahash_fragment>
	outgoingLight = diffuseColor.rgb;
	#include <opaque_fragment>
	#include <tonemapping_fragment>
	#include <colorspace_fragment>
	#include <fog_fragment>
	#include <premultiplied_alpha_fragment>
}`,py=`#include <common>
#include <batching_pars_vertex>
#include <fog_pars_vertex>
#include <morphtarget_pars_vertex>
#include <skinning_pars_vertex>
#include <logdepthbuf_pars_vertex>
#include <shadowmap_pars_vertex>
void main() {
	#include <batching_vertex>
	#include <beginnormal_vertex>
	#include <morphinstance_vertex>
	#include <morphnormal_vertex>
	#include <skinbase_vertex>
	#include <skinnormal_vertex>
	#include <defaultnormal_vertex>
	#include <begin_vertex>
	#include <morphtarget_vertex>
	#include <skinning_vertex>
	#include <project_vertex>
	#include <logdepthbuf_vertex>
	#include <worldpos_vertex>
	#include <shadowmap_vertex>
	#include <fog_vertex>
}`,my=`uniform vec3 color;
uniform float opacity;
#include <common>
#include <fog_pars_fragment>
#include <bsdfs>
#include <lights_pars_begin>
#include <logdepthbuf_pars_fragment>
#include <shadowmap_pars_fragment>
#include <shadowmask_pars_fragment>
void main() {
	#include <logdepthbuf_fragment>
	gl_FragColor = vec4( color, opacity * ( 1.0 - getShadowMask() ) );
	#include <tonemapping_fragment>
	#include <colorspace_fragment>
	#include <fog_fragment>
	#include <premultiplied_alpha_fragment>
}`,gy=`uniform float rotation;
uniform vec2 center;
#include <common>
#include <uv_pars_vertex>
#include <fog_pars_vertex>
#include <logdepthbuf_pars_vertex>
#include <clipping_planes_pars_vertex>
void main() {
	#include <uv_vertex>
	vec4 mvPosition = modelViewMatrix[ 3 ];
	vec2 scale = vec2( length( modelMatrix[ 0 ].xyz ), length( modelMatrix[ 1 ].xyz ) );
	#ifndef USE_SIZEATTENUATION
		bool isPerspective = isPerspectiveMatrix( projectionMatrix );
		if ( isPerspective ) scale *= - mvPosition.z;
	#endif
	vec2 alignedPosition = ( position.xy - ( center - vec2( 0.5 ) ) ) * scale;
	vec2 rotatedPosition;
	rotatedPosition.x = cos( rotation ) * alignedPosition.x - sin( rotation ) * alignedPosition.y;
	rotatedPosition.y = sin( rotation ) * alignedPosition.x + cos( rotation ) * alignedPosition.y;
	mvPosition.xy += rotatedPosition;
	gl_Position = projectionMatrix * mvPosition;
	#include <logdepthbuf_vertex>
	#include <clipping_planes_vertex>
	#include <fog_vertex>
}`,_y=`uniform vec3 diffuse;
uniform float opacity;
#include <common>
#include <uv_pars_fragment>
#include <map_pars_fragment>
#include <alphamap_pars_fragment>
#include <alphatest_pars_fragment>
#include <alphahash_pars_fragment>
#include <fog_pars_fragment>
#include <logdepthbuf_pars_fragment>
#include <clipping_planes_pars_fragment>
void main() {
	vec4 diffuseColor = vec4( diffuse, opacity );
	#include <clipping_planes_fragment>
	vec3 outgoingLight = vec3( 0.0 );
	#include <logdepthbuf_fragment>
	#include <map_fragment>
	#include <alphamap_fragment>
	#include <alphatest_fragment>
	#include <alphahash_fragment>
	outgoingLight = diffuseColor.rgb;
	#include <opaque_fragment>
	#include <tonemapping_fragment>
	#include <colorspace_fragment>
	#include <fog_fragment>
}`,ne={alphahash_fragment:k_,alphahash_pars_fragment:z_,alphamap_fragment:G_,alphamap_pars_fragment:V_,alphatest_fragment:H_,alphatest_pars_fragment:W_,aomap_fragment:X_,aomap_pars_fragment:q_,batching_pars_vertex:$_,batching_vertex:Y_,begin_vertex:Z_,beginnormal_vertex:J_,bsdfs:j_,iridescence_fragment:K_,bumpmap_pars_fragment:Q_,clipping_planes_fragment:tx,clipping_planes_pars_fragment:ex,clipping_planes_pars_vertex:nx,clipping_planes_vertex:ix,color_fragment:sx,color_pars_fragment:rx,color_pars_vertex:ox,color_vertex:ax,common:lx,defaultnormal_vertex:cx,displacementmap_pars_vertex:hx,displacementmap_vertex:ux,emissivemap_fragment:dx,emissivemap_pars_fragment:fx,colorspace_fragment:px,colorspace_pars_fragment:mx,envmap_fragment:gx,envmap_common_pars_fragment:_x,envmap_pars_fragment:xx,envmap_pars_vertex:vx,envmap_physical_pars_fragment:Px,envmap_vertex:yx,fog_vertex:bx,fog_pars_vertex:Mx,fog_fragment:Sx,fog_pars_fragment:wx,gradientmap_pars_fragment:Ex,lightmap_pars_fragment:Ax,lights_lambert_fragment:Tx,lights_lambert_pars_fragment:Cx,lights_pars_begin:Rx,lights_toon_fragment:Ix,lights_toon_pars_fragment:Lx,lights_phong_fragment:Dx,lights_phong_pars_fragment:Nx,lights_physical_fragment:Ux,lights_physical_pars_fragment:Ox,lights_fragment_begin:Fx,lights_fragment_maps:Bx,lights_fragment_end:kx,lightprobes_pars_fragment:zx,logdepthbuf_fragment:Gx,logdepthbuf_pars_fragment:Vx,logdepthbuf_pars_vertex:Hx,logdepthbuf_vertex:Wx,map_fragment:Xx,map_pars_fragment:qx,map_particle_fragment:$x,map_particle_pars_fragment:Yx,metalnessmap_fragment:Zx,metalnessmap_pars_fragment:Jx,morphinstance_vertex:jx,morphcolor_vertex:Kx,morphnormal_vertex:Qx,morphtarget_pars_vertex:tv,morphtarget_vertex:ev,normal_fragment_begin:nv,normal_fragment_maps:iv,normal_pars_fragment:sv,normal_pars_vertex:rv,normal_vertex:ov,normalmap_pars_fragment:av,clearcoat_normal_fragment_begin:lv,clearcoat_normal_fragment_maps:cv,clearcoat_pars_fragment:hv,iridescence_pars_fragment:uv,opaque_fragment:dv,packing:fv,premultiplied_alpha_fragment:pv,project_vertex:mv,dithering_fragment:gv,dithering_pars_fragment:_v,roughnessmap_fragment:xv,roughnessmap_pars_fragment:vv,shadowmap_pars_fragment:yv,shadowmap_pars_vertex:bv,shadowmap_vertex:Mv,shadowmask_pars_fragment:Sv,skinbase_vertex:wv,skinning_pars_vertex:Ev,skinning_vertex:Av,skinnormal_vertex:Tv,specularmap_fragment:Cv,specularmap_pars_fragment:Rv,tonemapping_fragment:Pv,tonemapping_pars_fragment:Iv,transmission_fragment:Lv,transmission_pars_fragment:Dv,uv_pars_fragment:Nv,uv_pars_vertex:Uv,uv_vertex:Ov,worldpos_vertex:Fv,background_vert:Bv,background_frag:kv,backgroundCube_vert:zv,backgroundCube_frag:Gv,cube_vert:Vv,cube_frag:Hv,depth_vert:Wv,depth_frag:Xv,distance_vert:qv,distance_frag:$v,equirect_vert:Yv,equirect_frag:Zv,linedashed_vert:Jv,linedashed_frag:jv,meshbasic_vert:Kv,meshbasic_frag:Qv,meshlambert_vert:ty,meshlambert_frag:ey,meshmatcap_vert:ny,meshmatcap_frag:iy,meshnormal_vert:sy,meshnormal_frag:ry,meshphong_vert:oy,meshphong_frag:ay,meshphysical_vert:ly,meshphysical_frag:cy,meshtoon_vert:hy,meshtoon_frag:uy,points_vert:dy,points_frag:fy,shadow_vert:py,shadow_frag:my,sprite_vert:gy,sprite_frag:_y},Mt={common:{diffuse:{value:new Yt(16777215)},opacity:{value:1},map:{value:null},mapTransform:{value:new $t},alphaMap:{value:null},alphaMapTransform:{value:new $t},alphaTest:{value:0}},specularmap:{specularMap:{value:null},specularMapTransform:{value:new $t}},envmap:{envMap:{value:null},envMapRotation:{value:new $t},reflectivity:{value:1},ior:{value:1.5},refractionRatio:{value:.98},dfgLUT:{value:null}},aomap:{aoMap:{value:null},aoMapIntensity:{value:1},aoMapTransform:{value:new $t}},lightmap:{lightMap:{value:null},lightMapIntensity:{value:1},lightMapTransform:{value:new $t}},bumpmap:{bumpMap:{value:null},bumpMapTransform:{value:new $t},bumpScale:{value:1}},normalmap:{normalMap:{value:null},normalMapTransform:{value:new $t},normalScale:{value:new rt(1,1)}},displacementmap:{displacementMap:{value:null},displacementMapTransform:{value:new $t},displacementScale:{value:1},displacementBias:{value:0}},emissivemap:{emissiveMap:{value:null},emissiveMapTransform:{value:new $t}},metalnessmap:{metalnessMap:{value:null},metalnessMapTransform:{value:new $t}},roughnessmap:{roughnessMap:{value:null},roughnessMapTransform:{value:new $t}},gradientmap:{gradientMap:{value:null}},fog:{fogDensity:{value:25e-5},fogNear:{value:1},fogFar:{value:2e3},fogColor:{value:new Yt(16777215)}},lights:{ambientLightColor:{value:[]},lightProbe:{value:[]},sunLights:{value:[],properties:{direction:{},color:{}}},sunLightShadows:{value:[],properties:{shadowIntensity:1,shadowBias:{},shadowNormalBias:{},shadowRadius:{},shadowMapSize:{}}},sunShadowMatrix:{value:[]},sunShadowCascade:{value:[]},directionalLights:{value:[],properties:{direction:{},color:{}}},directionalLightShadows:{value:[],properties:{shadowIntensity:1,shadowBias:{},shadowNormalBias:{},shadowRadius:{},shadowMapSize:{}}},directionalShadowMatrix:{value:[]},spotLights:{value:[],properties:{color:{},position:{},direction:{},distance:{},coneCos:{},penumbraCos:{},decay:{}}},spotLightShadows:{value:[],properties:{shadowIntensity:1,shadowBias:{},shadowNormalBias:{},shadowRadius:{},shadowMapSize:{}}},spotLightMap:{value:[]},spotLightMatrix:{value:[]},pointLights:{value:[],properties:{color:{},position:{},decay:{},distance:{}}},pointLightShadows:{value:[],properties:{shadowIntensity:1,shadowBias:{},shadowNormalBias:{},shadowRadius:{},shadowMapSize:{},shadowCameraNear:{},shadowCameraFar:{}}},pointShadowMatrix:{value:[]},hemisphereLights:{value:[],properties:{direction:{},skyColor:{},groundColor:{}}},rectAreaLights:{value:[],properties:{color:{},position:{},width:{},height:{}}},ltc_1:{value:null},ltc_2:{value:null},probesSH:{value:[]},probesMin:{value:[]},probesMax:{value:[]},probesResolution:{value:[]}},points:{diffuse:{value:new Yt(16777215)},opacity:{value:1},size:{value:1},scale:{value:1},map:{value:null},alphaMap:{value:null},alphaMapTransform:{value:new $t},alphaTest:{value:0},uvTransform:{value:new $t}},sprite:{diffuse:{value:new Yt(16777215)},opacity:{value:1},center:{value:new rt(.5,.5)},rotation:{value:0},map:{value:null},mapTransform:{value:new $t},alphaMap:{value:null},alphaMapTransform:{value:new $t},alphaTest:{value:0}}},ni={basic:{uniforms:on([Mt.common,Mt.specularmap,Mt.envmap,Mt.aomap,Mt.lightmap,Mt.fog]),vertexShader:ne.meshbasic_vert,fragmentShader:ne.meshbasic_frag},lambert:{uniforms:on([Mt.common,Mt.specularmap,Mt.envmap,Mt.aomap,Mt.lightmap,Mt.emissivemap,Mt.bumpmap,Mt.normalmap,Mt.displacementmap,Mt.fog,Mt.lights,{emissive:{value:new Yt(0)},envMapIntensity:{value:1}}]),vertexShader:ne.meshlambert_vert,fragmentShader:ne.meshlambert_frag},phong:{uniforms:on([Mt.common,Mt.specularmap,Mt.envmap,Mt.aomap,Mt.lightmap,Mt.emissivemap,Mt.bumpmap,Mt.normalmap,Mt.displacementmap,Mt.fog,Mt.lights,{emissive:{value:new Yt(0)},specular:{value:new Yt(1118481)},shininess:{value:30},envMapIntensity:{value:1}}]),vertexShader:ne.meshphong_vert,fragmentShader:ne.meshphong_frag},standard:{uniforms:on([Mt.common,Mt.envmap,Mt.aomap,Mt.lightmap,Mt.emissivemap,Mt.bumpmap,Mt.normalmap,Mt.displacementmap,Mt.roughnessmap,Mt.metalnessmap,Mt.fog,Mt.lights,{emissive:{value:new Yt(0)},roughness:{value:1},metalness:{value:0},envMapIntensity:{value:1}}]),vertexShader:ne.meshphysical_vert,fragmentShader:ne.meshphysical_frag},toon:{uniforms:on([Mt.common,Mt.aomap,Mt.lightmap,Mt.emissivemap,Mt.bumpmap,Mt.normalmap,Mt.displacementmap,Mt.gradientmap,Mt.fog,Mt.lights,{emissive:{value:new Yt(0)}}]),vertexShader:ne.meshtoon_vert,fragmentShader:ne.meshtoon_frag},matcap:{uniforms:on([Mt.common,Mt.bumpmap,Mt.normalmap,Mt.displacementmap,Mt.fog,{matcap:{value:null}}]),vertexShader:ne.meshmatcap_vert,fragmentShader:ne.meshmatcap_frag},points:{uniforms:on([Mt.points,Mt.fog]),vertexShader:ne.points_vert,fragmentShader:ne.points_frag},dashed:{uniforms:on([Mt.common,Mt.fog,{scale:{value:1},dashSize:{value:1},totalSize:{value:2}}]),vertexShader:ne.linedashed_vert,fragmentShader:ne.linedashed_frag},depth:{uniforms:on([Mt.common,Mt.displacementmap]),vertexShader:ne.depth_vert,fragmentShader:ne.depth_frag},normal:{uniforms:on([Mt.common,Mt.bumpmap,Mt.normalmap,Mt.displacementmap,{opacity:{value:1}}]),vertexShader:ne.meshnormal_vert,fragmentShader:ne.meshnormal_frag},sprite:{uniforms:on([Mt.sprite,Mt.fog]),vertexShader:ne.sprite_vert,fragmentShader:ne.sprite_frag},background:{uniforms:{uvTransform:{value:new $t},t2D:{value:null},backgroundIntensity:{value:1}},vertexShader:ne.background_vert,fragmentShader:ne.background_frag},backgroundCube:{uniforms:{envMap:{value:null},backgroundBlurriness:{value:0},backgroundIntensity:{value:1},backgroundRotation:{value:new $t}},vertexShader:ne.backgroundCube_vert,fragmentShader:ne.backgroundCube_frag},cube:{uniforms:{tCube:{value:null},tFlip:{value:-1},opacity:{value:1}},vertexShader:ne.cube_vert,fragmentShader:ne.cube_frag},equirect:{uniforms:{tEquirect:{value:null}},vertexShader:ne.equirect_vert,fragmentShader:ne.equirect_frag},distance:{uniforms:on([Mt.common,Mt.displacementmap,{referencePosition:{value:new I},nearDistance:{value:1},farDistance:{value:1e3}}]),vertexShader:ne.distance_vert,fragmentShader:ne.distance_frag},shadow:{uniforms:on([Mt.lights,Mt.fog,{color:{value:new Yt(0)},opacity:{value:1}}]),vertexShader:ne.shadow_vert,fragmentShader:ne.shadow_frag}};ni.physical={uniforms:on([ni.standard.uniforms,{clearcoat:{value:0},clearcoatMap:{value:null},clearcoatMapTransform:{value:new $t},clearcoatNormalMap:{value:null},clearcoatNormalMapTransform:{value:new $t},clearcoatNormalScale:{value:new rt(1,1)},clearcoatRoughness:{value:0},clearcoatRoughnessMap:{value:null},clearcoatRoughnessMapTransform:{value:new $t},diffuseRoughness:{value:0},diffuseRoughnessMap:{value:null},diffuseRoughnessMapTransform:{value:new $t},dispersion:{value:0},retroreflectivity:{value:0},iridescence:{value:0},iridescenceMap:{value:null},iridescenceMapTransform:{value:new $t},iridescenceIOR:{value:1.3},iridescenceThicknessMinimum:{value:100},iridescenceThicknessMaximum:{value:400},iridescenceThicknessMap:{value:null},iridescenceThicknessMapTransform:{value:new $t},sheen:{value:0},sheenColor:{value:new Yt(0)},sheenColorMap:{value:null},sheenColorMapTransform:{value:new $t},sheenRoughness:{value:1},sheenRoughnessMap:{value:null},sheenRoughnessMapTransform:{value:new $t},transmission:{value:0},transmissionMap:{value:null},transmissionMapTransform:{value:new $t},transmissionSamplerSize:{value:new rt},transmissionSamplerMap:{value:null},thickness:{value:0},thicknessMap:{value:null},thicknessMapTransform:{value:new $t},attenuationDistance:{value:0},attenuationColor:{value:new Yt(0)},specularColor:{value:new Yt(1,1,1)},specularColorMap:{value:null},specularColorMapTransform:{value:new $t},specularIntensity:{value:1},specularIntensityMap:{value:null},specularIntensityMapTransform:{value:new $t},anisotropyVector:{value:new rt},anisotropyMap:{value:null},anisotropyMapTransform:{value:new $t}}]),vertexShader:ne.meshphysical_vert,fragmentShader:ne.meshphysical_frag};var ql={r:0,b:0,g:0},xy=new ue,Hp=new $t;Hp.set(-1,0,0,0,1,0,0,0,1);function vy(i,t,e,n,s,r){let o=new Yt(0),a=s===!0?0:1,l,c,h=null,u=0,d=null;function f(y){let w=y.isScene===!0?y.background:null;if(w&&w.isTexture){let S=y.backgroundBlurriness>0;w=t.get(w,S)}return w}function m(y){let w=!1,S=f(y);S===null?p(o,a):S&&S.isColor&&(p(S,1),w=!0);let T=i.xr.getEnvironmentBlendMode();T==="additive"?e.buffers.color.setClear(0,0,0,1,r):T==="alpha-blend"&&e.buffers.color.setClear(0,0,0,0,r),(i.autoClear||w)&&(e.buffers.depth.setTest(!0),e.buffers.depth.setMask(!0),e.buffers.color.setMask(!0),i.clear(i.autoClearColor,i.autoClearDepth,i.autoClearStencil))}function x(y,w){let S=f(w);S&&S.isCubeTexture?(c===void 0&&(c=new Ee(new Vs(1,1,1),new Je({name:"BackgroundCubeMaterial",uniforms:ds(ni.backgroundCube.uniforms),vertexShader:ni.backgroundCube.vertexShader,fragmentShader:ni.backgroundCube.fragmentShader,side:Ge,depthTest:!1,depthWrite:!1,fog:!1,allowOverride:!1})),c.geometry.deleteAttribute("normal"),c.geometry.deleteAttribute("uv"),c.onBeforeRender=function(T,A,_){this.matrixWorld.copyPosition(_.matrixWorld)},Object.defineProperty(c.material,"envMap",{get:function(){return this.uniforms.envMap.value}}),n.update(c)),c.material.uniforms.envMap.value=S,c.material.uniforms.backgroundBlurriness.value=w.backgroundBlurriness,c.material.uniforms.backgroundIntensity.value=w.backgroundIntensity,c.material.uniforms.backgroundRotation.value.setFromMatrix4(xy.makeRotationFromEuler(w.backgroundRotation)).transpose(),S.isRenderTargetTexture===!1&&c.material.uniforms.backgroundRotation.value.premultiply(Hp),c.material.toneMapped=se.getTransfer(S.colorSpace)!==_e,(h!==S||u!==S.version||d!==i.toneMapping)&&(c.material.needsUpdate=!0,h=S,u=S.version,d=i.toneMapping),c.layers.enableAll(),y.unshift(c,c.geometry,c.material,0,0,null)):S&&S.isTexture&&(l===void 0&&(l=new Ee(new Bi(2,2),new Je({name:"BackgroundMaterial",uniforms:ds(ni.background.uniforms),vertexShader:ni.background.vertexShader,fragmentShader:ni.background.fragmentShader,side:bn,depthTest:!1,depthWrite:!1,fog:!1,allowOverride:!1})),l.geometry.deleteAttribute("normal"),Object.defineProperty(l.material,"map",{get:function(){return this.uniforms.t2D.value}}),n.update(l)),l.material.uniforms.t2D.value=S,l.material.uniforms.backgroundIntensity.value=w.backgroundIntensity,l.material.toneMapped=se.getTransfer(S.colorSpace)!==_e,S.matrixAutoUpdate===!0&&S.updateMatrix(),l.material.uniforms.uvTransform.value.copy(S.matrix),(h!==S||u!==S.version||d!==i.toneMapping)&&(l.material.needsUpdate=!0,h=S,u=S.version,d=i.toneMapping),l.layers.enableAll(),y.unshift(l,l.geometry,l.material,0,0,null))}function p(y,w){y.getRGB(ql,hu(i)),e.buffers.color.setClear(ql.r,ql.g,ql.b,w,r)}function g(){c!==void 0&&(c.geometry.dispose(),c.material.dispose(),c=void 0),l!==void 0&&(l.geometry.dispose(),l.material.dispose(),l=void 0)}return{getClearColor:function(){return o},setClearColor:function(y,w=1){o.set(y),a=w,p(o,a)},getClearAlpha:function(){return a},setClearAlpha:function(y){a=y,p(o,a)},render:m,addToRenderList:x,dispose:g}}function yy(i,t){let e=i.getParameter(i.MAX_VERTEX_ATTRIBS),n={},s=d(null),r=s,o=!1;function a(U,G,$,L,V){let X=!1,z=u(U,L,$,G);r!==z&&(r=z,c(r.object)),X=f(U,L,$,V),X&&m(U,L,$,V),V!==null&&t.update(V,i.ELEMENT_ARRAY_BUFFER),(X||o)&&(o=!1,S(U,G,$,L),V!==null&&i.bindBuffer(i.ELEMENT_ARRAY_BUFFER,t.get(V).buffer))}function l(){return i.createVertexArray()}function c(U){return i.bindVertexArray(U)}function h(U){return i.deleteVertexArray(U)}function u(U,G,$,L){let V=L.wireframe===!0,X=n[G.id];X===void 0&&(X={},n[G.id]=X);let z=U.isInstancedMesh===!0?U.id:0,nt=X[z];nt===void 0&&(nt={},X[z]=nt);let H=nt[$.id];H===void 0&&(H={},nt[$.id]=H);let Q=H[V];return Q===void 0&&(Q=d(l()),H[V]=Q),Q}function d(U){let G=[],$=[],L=[];for(let V=0;V<e;V++)G[V]=0,$[V]=0,L[V]=0;return{geometry:null,program:null,wireframe:!1,newAttributes:G,enabledAttributes:$,attributeDivisors:L,object:U,attributes:{},index:null}}function f(U,G,$,L){let V=r.attributes,X=G.attributes,z=0,nt=$.getAttributes();for(let H in nt)if(nt[H].location>=0){let et=V[H],Et=X[H];if(Et===void 0&&(H==="instanceMatrix"&&U.instanceMatrix&&(Et=U.instanceMatrix),H==="instanceColor"&&U.instanceColor&&(Et=U.instanceColor)),et===void 0||et.attribute!==Et||Et&&et.data!==Et.data)return!0;z++}return r.attributesNum!==z||r.index!==L}function m(U,G,$,L){let V={},X=G.attributes,z=0,nt=$.getAttributes();for(let H in nt)if(nt[H].location>=0){let et=X[H];et===void 0&&(H==="instanceMatrix"&&U.instanceMatrix&&(et=U.instanceMatrix),H==="instanceColor"&&U.instanceColor&&(et=U.instanceColor));let Et={};Et.attribute=et,et&&et.data&&(Et.data=et.data),V[H]=Et,z++}r.attributes=V,r.attributesNum=z,r.index=L}function x(){let U=r.newAttributes;for(let G=0,$=U.length;G<$;G++)U[G]=0}function p(U){g(U,0)}function g(U,G){let $=r.newAttributes,L=r.enabledAttributes,V=r.attributeDivisors;$[U]=1,L[U]===0&&(i.enableVertexAttribArray(U),L[U]=1),V[U]!==G&&(i.vertexAttribDivisor(U,G),V[U]=G)}function y(){let U=r.newAttributes,G=r.enabledAttributes;for(let $=0,L=G.length;$<L;$++)G[$]!==U[$]&&(i.disableVertexAttribArray($),G[$]=0)}function w(U,G,$,L,V,X,z){z===!0?i.vertexAttribIPointer(U,G,$,V,X):i.vertexAttribPointer(U,G,$,L,V,X)}function S(U,G,$,L){x();let V=L.attributes,X=$.getAttributes(),z=G.defaultAttributeValues;for(let nt in X){let H=X[nt];if(H.location>=0){let Q=V[nt];if(Q===void 0&&(nt==="instanceMatrix"&&U.instanceMatrix&&(Q=U.instanceMatrix),nt==="instanceColor"&&U.instanceColor&&(Q=U.instanceColor)),Q!==void 0){let et=Q.normalized,Et=Q.itemSize,Nt=t.get(Q);if(Nt===void 0)continue;let Y=Nt.buffer,ht=Nt.type,At=Nt.bytesPerElement,Ot=ht===i.INT||ht===i.UNSIGNED_INT||Q.gpuType===ll;if(Q.isInterleavedBufferAttribute){let vt=Q.data,Bt=vt.isInterleavedBuffer===!0?vt.stride:vt.itemSize,ye=Q.offset;if(vt.isInstancedInterleavedBuffer||vt.isInstancedBufferAttribute){for(let kt=0;kt<H.locationSize;kt++)g(H.location+kt,vt.meshPerAttribute);U.isInstancedMesh!==!0&&L._maxInstanceCount===void 0&&(L._maxInstanceCount=vt.meshPerAttribute*vt.count)}else for(let kt=0;kt<H.locationSize;kt++)p(H.location+kt);i.bindBuffer(i.ARRAY_BUFFER,Y);for(let kt=0;kt<H.locationSize;kt++)w(H.location+kt,Et/H.locationSize,ht,et,Bt*At,(ye+Et/H.locationSize*kt)*At,Ot)}else{if(Q.isInstancedBufferAttribute){for(let vt=0;vt<H.locationSize;vt++)g(H.location+vt,Q.meshPerAttribute);U.isInstancedMesh!==!0&&L._maxInstanceCount===void 0&&(L._maxInstanceCount=Q.meshPerAttribute*Q.count)}else for(let vt=0;vt<H.locationSize;vt++)p(H.location+vt);i.bindBuffer(i.ARRAY_BUFFER,Y);for(let vt=0;vt<H.locationSize;vt++)w(H.location+vt,Et/H.locationSize,ht,et,Et*At,Et/H.locationSize*vt*At,Ot)}}else if(z!==void 0){let et=z[nt];if(et!==void 0)switch(et.length){case 2:i.vertexAttrib2fv(H.location,et);break;case 3:i.vertexAttrib3fv(H.location,et);break;case 4:i.vertexAttrib4fv(H.location,et);break;default:i.vertexAttrib1fv(H.location,et)}}}}y()}function T(){O();for(let U in n){let G=n[U];for(let $ in G){let L=G[$];for(let V in L){let X=L[V];for(let z in X)h(X[z].object),delete X[z];delete L[V]}}delete n[U]}}function A(U){if(n[U.id]===void 0)return;let G=n[U.id];for(let $ in G){let L=G[$];for(let V in L){let X=L[V];for(let z in X)h(X[z].object),delete X[z];delete L[V]}}delete n[U.id]}function _(U){for(let G in n){let $=n[G];for(let L in $){let V=$[L];if(V[U.id]===void 0)continue;let X=V[U.id];for(let z in X)h(X[z].object),delete X[z];delete V[U.id]}}}function E(U){for(let G in n){let $=n[G],L=U.isInstancedMesh===!0?U.id:0,V=$[L];if(V!==void 0){for(let X in V){let z=V[X];for(let nt in z)h(z[nt].object),delete z[nt];delete V[X]}delete $[L],Object.keys($).length===0&&delete n[G]}}}function O(){P(),o=!0,r!==s&&(r=s,c(r.object))}function P(){s.geometry=null,s.program=null,s.wireframe=!1}return{setup:a,reset:O,resetDefaultState:P,dispose:T,releaseStatesOfGeometry:A,releaseStatesOfObject:E,releaseStatesOfProgram:_,initAttributes:x,enableAttribute:p,disableUnusedAttributes:y}}function by(i,t,e){let n;function s(l){n=l}function r(l,c){i.drawArrays(n,l,c),e.update(c,n,1)}function o(l,c,h){h!==0&&(i.drawArraysInstanced(n,l,c,h),e.update(c,n,h))}function a(l,c,h){if(h===0)return;t.get("WEBGL_multi_draw").multiDrawArraysWEBGL(n,l,0,c,0,h);let d=0;for(let f=0;f<h;f++)d+=c[f];e.update(d,n,1)}this.setMode=s,this.render=r,this.renderInstances=o,this.renderMultiDraw=a}function My(i,t,e,n){let s;function r(){if(s!==void 0)return s;if(t.has("EXT_texture_filter_anisotropic")===!0){let _=t.get("EXT_texture_filter_anisotropic");s=i.getParameter(_.MAX_TEXTURE_MAX_ANISOTROPY_EXT)}else s=0;return s}function o(_){return!(_!==Sn&&n.convert(_)!==i.getParameter(i.IMPLEMENTATION_COLOR_READ_FORMAT))}function a(_){let E=_===zn&&(t.has("EXT_color_buffer_half_float")||t.has("EXT_color_buffer_float"));return!(_!==Mn&&_!==fn&&!E&&n.convert(_)!==i.getParameter(i.IMPLEMENTATION_COLOR_READ_TYPE))}function l(_){if(_==="highp"){if(i.getShaderPrecisionFormat(i.VERTEX_SHADER,i.HIGH_FLOAT).precision>0&&i.getShaderPrecisionFormat(i.FRAGMENT_SHADER,i.HIGH_FLOAT).precision>0)return"highp";_="mediump"}return _==="mediump"&&i.getShaderPrecisionFormat(i.VERTEX_SHADER,i.MEDIUM_FLOAT).precision>0&&i.getShaderPrecisionFormat(i.FRAGMENT_SHADER,i.MEDIUM_FLOAT).precision>0?"mediump":"lowp"}let c=e.precision!==void 0?e.precision:"highp",h=l(c);h!==c&&(Vt("WebGLRenderer:",c,"not supported, using",h,"instead."),c=h);let u=e.reversedDepthBuffer===!0&&t.has("EXT_clip_control"),d=e.logarithmicDepthBuffer===!0&&u===!1;e.reversedDepthBuffer===!0&&u===!1&&Vt("WebGLRenderer: Unable to use reversed depth buffer due to missing EXT_clip_control extension. Fallback to default depth buffer."),e.logarithmicDepthBuffer===!0&&u===!0&&Vt("WebGLRenderer: Logarithmic depth buffer is ignored when reversed depth buffer is enabled.");let f=i.getParameter(i.MAX_TEXTURE_IMAGE_UNITS),m=i.getParameter(i.MAX_VERTEX_TEXTURE_IMAGE_UNITS),x=i.getParameter(i.MAX_TEXTURE_SIZE),p=i.getParameter(i.MAX_CUBE_MAP_TEXTURE_SIZE),g=i.getParameter(i.MAX_VERTEX_ATTRIBS),y=i.getParameter(i.MAX_VERTEX_UNIFORM_VECTORS),w=i.getParameter(i.MAX_VARYING_VECTORS),S=i.getParameter(i.MAX_FRAGMENT_UNIFORM_VECTORS),T=i.getParameter(i.MAX_SAMPLES),A=i.getParameter(i.SAMPLES);return{isWebGL2:!0,getMaxAnisotropy:r,getMaxPrecision:l,textureFormatReadable:o,textureTypeReadable:a,precision:c,logarithmicDepthBuffer:d,reversedDepthBuffer:u,maxTextures:f,maxVertexTextures:m,maxTextureSize:x,maxCubemapSize:p,maxAttributes:g,maxVertexUniforms:y,maxVaryings:w,maxFragmentUniforms:S,maxSamples:T,samples:A}}function Sy(i){let t=this,e=null,n=0,s=!1,r=!1,o=new xn,a=new $t,l={value:null,needsUpdate:!1};this.uniform=l,this.numPlanes=0,this.numIntersection=0,this.init=function(u,d){let f=u.length!==0||d||n!==0||s;return s=d,n=u.length,f},this.beginShadows=function(){r=!0,h(null)},this.endShadows=function(){r=!1},this.setGlobalState=function(u,d){e=h(u,d,0)},this.setState=function(u,d,f){let m=u.clippingPlanes,x=u.clipIntersection,p=u.clipShadows,g=i.get(u);if(!s||m===null||m.length===0||r&&!p)r?h(null):c();else{let y=r?0:n,w=y*4,S=g.clippingState||null;l.value=S,S=h(m,d,w,f);for(let T=0;T!==w;++T)S[T]=e[T];g.clippingState=S,this.numIntersection=x?this.numPlanes:0,this.numPlanes+=y}};function c(){l.value!==e&&(l.value=e,l.needsUpdate=n>0),t.numPlanes=n,t.numIntersection=0}function h(u,d,f,m){let x=u!==null?u.length:0,p=null;if(x!==0){if(p=l.value,m!==!0||p===null){let g=f+x*4,y=d.matrixWorldInverse;a.getNormalMatrix(y),(p===null||p.length<g)&&(p=new Float32Array(g));for(let w=0,S=f;w!==x;++w,S+=4)o.copy(u[w]).applyMatrix4(y,a),o.normal.toArray(p,S),p[S+3]=o.constant}l.value=p,l.needsUpdate=!0}return t.numPlanes=x,t.numIntersection=0,p}}var uo=class extends Ze{constructor(t=1,e={}){super(t,t,e),this.isWebGLCubeRenderTarget=!0;let n={width:t,height:t,depth:1},s=[n,n,n,n,n,n];this.texture=new Or(s),this._setTextureOptions(e),this.texture.isRenderTargetTexture=!0}fromEquirectangularTexture(t,e){this.texture.type=e.type,this.texture.colorSpace=e.colorSpace,this.texture.generateMipmaps=e.generateMipmaps,this.texture.minFilter=e.minFilter,this.texture.magFilter=e.magFilter;let n={uniforms:{tEquirect:{value:null}},vertexShader:`

				varying vec3 vWorldDirection;

				vec3 transformDirection( in vec3 dir, in mat4 matrix ) {

					return normalize( ( matrix * vec4( dir, 0.0 ) ).xyz );

				}

				void main() {

					vWorldDirection = transformDirection( position, modelMatrix );

					#include <begin_vertex>
					#include <project_vertex>

				}
			`,fragmentShader:`

				uniform sampler2D tEquirect;

				varying vec3 vWorldDirection;

				#include <common>

				void main() {

					vec3 direction = normalize( vWorldDirection );

					vec2 sampleUV = equirectUv( direction );

					gl_FragColor = texture2D( tEquirect, sampleUV );

				}
			`},s=new Vs(5,5,5),r=new Je({name:"CubemapFromEquirect",uniforms:ds(n.uniforms),vertexShader:n.vertexShader,fragmentShader:n.fragmentShader,side:Ge,blending:as});r.uniforms.tEquirect.value=e;let o=new Ee(s,r),a=e.minFilter;return e.minFilter===bi&&(e.minFilter=Ye),new qs(1,10,this).update(t,o),e.minFilter=a,o.geometry.dispose(),o.material.dispose(),this}clear(t,e=!0,n=!0,s=!0){let r=t.getRenderTarget();for(let o=0;o<6;o++)t.setRenderTarget(this,o),t.clear(e,n,s);t.setRenderTarget(r)}},bp=256,wy=3,Ey=20,Wp=256,Xp=16,Ay=3,Ty=new I,Cy=new Yt,Yl=class i{constructor(t){this._renderer=t,this._cubeSize=0,this._sourceTarget=null,this._cubeCamera=new qs(1,10,null),this._boxMesh=new Ee(new Vs(5,5,5),null),this._cubemapMaterial=null,this._equirectMaterial=null,this._blurMaterial=null,this._ggxMaterial=null,this._integrationMaterial=null}fromScene(t,e=0,n=.1,s=100,r={}){let{size:o=256,position:a=Ty}=r,l=this._renderer;this._setSize(o);let c=this._allocateTarget(),h=this._getSourceTarget(!0);e>0&&(h.texture.mipmapsAutoUpdate=!1);let u=l.autoClear,d=l.autoClearColor,f=l.autoClearDepth,m=l.autoClearStencil,x=t.background;l.autoClear=!0,l.autoClearColor=!0,l.autoClearDepth=!0,l.autoClearStencil=!0,x===null&&(t.background=l.getClearColor(Cy));let p=new qs(n,s,h);return p.position.copy(a),p.update(l,t),l.autoClear=u,l.autoClearColor=d,l.autoClearDepth=f,l.autoClearStencil=m,t.background=x,e>0&&(h.texture.mipmapsAutoUpdate=!0,this._blur(c,e)),this._applyPMREM(c),c}fromEquirectangular(t,e=null){return this._fromTexture(t,e)}fromCubemap(t,e=null){return this._fromTexture(t,e)}compileCubemapShader(){this._cubemapMaterial===null&&(this._cubemapMaterial=wp(),this._compileMaterial(this._cubemapMaterial))}compileEquirectangularShader(){this._equirectMaterial===null&&(this._equirectMaterial=Sp(),this._compileMaterial(this._equirectMaterial))}dispose(){this._sourceTarget!==null&&this._sourceTarget.dispose(),this._cubemapMaterial!==null&&this._cubemapMaterial.dispose(),this._equirectMaterial!==null&&this._equirectMaterial.dispose(),this._blurMaterial!==null&&this._blurMaterial.dispose(),this._ggxMaterial!==null&&this._ggxMaterial.dispose(),this._integrationMaterial!==null&&this._integrationMaterial.dispose(),this._boxMesh.geometry.dispose()}static lodToRoughness(t,e){return e>0?1-Math.sqrt(1-t/e):0}_setSize(t){this._cubeSize=Math.max(bp,ou(t))}_fromTexture(t,e){t.mapping===cs||t.mapping===Zs?this._setSize(t.image.length===0?bp:t.image[0].width||t.image[0].image.width):this._setSize(t.image.width/4);let n=e||this._allocateTarget();return this._textureToCubemap(t),this._applyPMREM(n),n}_allocateTarget(){let t=this._cubeSize,e=Mp(t,!1,!1),n=Math.log2(t)-wy;for(let s=0;s<=n;s++)e.texture.mipmaps.push({width:t>>s,height:t>>s});return e.texture.name="PMREM",e.texture.isPMREMTexture=!0,e}_getSourceTarget(t=!1){let e=this._cubeSize,n=this._sourceTarget;return(n===null||n.width!==e||t&&n.depthBuffer===!1)&&(n!==null&&n.dispose(),this._sourceTarget=Mp(e,!0,t)),this._sourceTarget}_compileMaterial(t){this._boxMesh.material=t,this._renderer.compile(this._boxMesh,this._cubeCamera.children[0])}_renderCube(t,e,n){let s=this._boxMesh,r=this._cubeCamera;s.material=n,r.renderTarget=t,r.activeMipmapLevel=e;let o=t.width>>e;t.viewport.set(0,0,o,o),r.update(this._renderer,s),t.viewport.set(0,0,t.width,t.height)}_textureToCubemap(t){let e;t.mapping===cs||t.mapping===Zs?(this._cubemapMaterial===null&&(this._cubemapMaterial=wp()),e=this._cubemapMaterial,e.uniforms.flipEnvMap.value=t.isRenderTargetTexture===!1?-1:1):(this._equirectMaterial===null&&(this._equirectMaterial=Sp()),e=this._equirectMaterial),e.uniforms.envMap.value=t,this._renderCube(this._getSourceTarget(),0,e)}_applyPMREM(t){this._ggxMaterial===null&&(this._ggxMaterial=Ry(),this._integrationMaterial=Py());let e=this._cubeSize,n=t.texture.mipmaps.length-1,s=this._ggxMaterial.uniforms;s.envMap.value=this._sourceTarget.texture;let r=this._integrationMaterial.uniforms;r.envMap.value=this._sourceTarget.texture,r.sourceLod.value=Math.log2(e/Xp);for(let o=0;o<=n;o++){let a=i.lodToRoughness(o,n);if(o>n-Ay)r.roughness.value=a,this._renderCube(t,o,this._integrationMaterial);else{let l=a>0?Math.log2(e)+.5*Math.log2(6/(Wp*Math.pow(a,4)))+.5:0;s.roughness.value=a,s.lodBias.value=l,this._renderCube(t,o,this._ggxMaterial)}}}_blur(t,e){this._blurMaterial===null&&(this._blurMaterial=Iy());let n=this._blurMaterial,s=n.uniforms,r=this._sourceTarget;s.sigma.value=Math.min(e,Math.PI)/Math.SQRT2,s.envMap.value=r.texture,this._renderCube(t,0,n),s.envMap.value=t.texture,this._renderCube(r,0,n)}};function Mp(i,t,e){return new uo(i,{minFilter:bi,generateMipmaps:t,type:zn,colorSpace:ns,depthBuffer:e})}function fo(i,t,e){return new Je({name:i,uniforms:t,vertexShader:ne.cube_vert,fragmentShader:e,side:Ge,blending:as,depthTest:!1,depthWrite:!1})}function Ry(){return fo("PMREMGGXConvolution",{envMap:{value:null},roughness:{value:0},lodBias:{value:0}},`

		#define GGX_SAMPLES ${Wp}u

		varying vec3 vWorldDirection;

		uniform samplerCube envMap;
		uniform float roughness;
		uniform float lodBias;

		#include <common>

		// Van der Corput radical inverse
		float radicalInverse_VdC( uint bits ) {

			bits = ( bits << 16u ) | ( bits >> 16u );
			bits = ( ( bits & 0x55555555u ) << 1u ) | ( ( bits & 0xAAAAAAAAu ) >> 1u );
			bits = ( ( bits & 0x33333333u ) << 2u ) | ( ( bits & 0xCCCCCCCCu ) >> 2u );
			bits = ( ( bits & 0x0F0F0F0Fu ) << 4u ) | ( ( bits & 0xF0F0F0F0u ) >> 4u );
			bits = ( ( bits & 0x00FF00FFu ) << 8u ) | ( ( bits & 0xFF00FF00u ) >> 8u );
			return float( bits ) * 2.3283064365386963e-10; // / 0x100000000

		}

		// Hammersley sequence
		vec2 hammersley( uint i, uint N ) {

			return vec2( float( i ) / float( N ), radicalInverse_VdC( i ) );

		}

		void main() {

			vec3 N = normalize( vWorldDirection );

			// For very low roughness, just sample the environment directly
			if ( roughness < 0.001 ) {

				gl_FragColor = vec4( textureLod( envMap, N, 0.0 ).rgb, 1.0 );
				return;

			}

			float alpha = roughness * roughness;
			float alpha2 = alpha * alpha;

			// Tangent space basis for VNDF sampling
			vec3 up = abs( N.z ) < 0.999 ? vec3( 0.0, 0.0, 1.0 ) : vec3( 1.0, 0.0, 0.0 );
			vec3 tangent = normalize( cross( up, N ) );
			vec3 bitangent = cross( N, tangent );

			vec3 prefilteredColor = vec3( 0.0 );
			float totalWeight = 0.0;

			for ( uint i = 0u; i < GGX_SAMPLES; i ++ ) {

				vec2 Xi = hammersley( i, GGX_SAMPLES );

				// With V = N, sample the reflected direction directly.
				float invQ = 1.0 / ( 1.0 - Xi.x + alpha2 * Xi.x );
				float NdotL = ( 1.0 - Xi.x - alpha2 * Xi.x ) * invQ;

				if ( NdotL > 0.0 ) {

					float phi = 2.0 * PI * Xi.y;
					float sinTheta = 2.0 * alpha * sqrt( Xi.x * ( 1.0 - Xi.x ) ) * invQ;
					vec3 L = N * NdotL + ( tangent * cos( phi ) + bitangent * sin( phi ) ) * sinTheta;

					// Match the source mip to the sample's solid angle. The terms
					// independent of the sample are precomputed in lodBias.
					float d = alpha2 * invQ;
					float lod = max( log2( d ) + lodBias, 0.0 );

					// Weight by NdotL for the split-sum approximation
					prefilteredColor += textureLod( envMap, L, lod ).rgb * NdotL;
					totalWeight += NdotL;

				}

			}

			gl_FragColor = vec4( prefilteredColor / totalWeight, 1.0 );

		}
	`)}function Py(){return fo("PMREMGGXIntegration",{envMap:{value:null},roughness:{value:0},sourceLod:{value:0},sourceSize:{value:Xp}},`

		varying vec3 vWorldDirection;

		uniform samplerCube envMap;
		uniform float roughness;
		uniform float sourceLod;
		uniform int sourceSize;

		void main() {

			vec3 N = normalize( vWorldDirection );

			float alpha = roughness * roughness;
			float alpha2 = alpha * alpha;

			float texelSize = 2.0 / float( sourceSize );

			vec3 prefilteredColor = vec3( 0.0 );
			float totalWeight = 0.0;

			// Pair opposite texels: only the one in N's hemisphere contributes.
			for ( int face = 0; face < 3; face ++ ) {

				for ( int y = 0; y < sourceSize; y ++ ) {

					for ( int x = 0; x < sourceSize; x ++ ) {

						vec2 uv = ( vec2( x, y ) + 0.5 ) * texelSize - 1.0;
						vec3 texelDirection = face == 0 ? vec3( 1.0, uv ) : ( face == 1 ? vec3( uv.x, 1.0, uv.y ) : vec3( uv, 1.0 ) );

						float invDistance = inversesqrt( 1.0 + dot( uv, uv ) );
						float NdotL = dot( N, texelDirection );
						texelDirection *= NdotL < 0.0 ? - 1.0 : 1.0;
						NdotL = abs( NdotL ) * invDistance;

						// With V = N, NdotH squared is ( 1 + NdotL ) / 2. Common factors
						// in the GGX distribution and texel solid angle cancel when normalized.
						float d = 1.0 + alpha2 + ( alpha2 - 1.0 ) * NdotL;
						float weight = NdotL * invDistance * invDistance * invDistance / ( d * d );

						prefilteredColor += textureLod( envMap, texelDirection, sourceLod ).rgb * weight;
						totalWeight += weight;

					}

				}

			}

			gl_FragColor = vec4( prefilteredColor / totalWeight, 1.0 );

		}
	`)}function Iy(){return fo("PMREMSphericalGaussianBlur",{envMap:{value:null},sigma:{value:0}},`

		#define SAMPLES ${Ey}
		#define GOLDEN_ANGLE 2.39996322973

		varying vec3 vWorldDirection;

		uniform samplerCube envMap;
		uniform float sigma;

		#include <common>

		void main() {

			vec3 outputDirection = normalize( vWorldDirection );

			vec3 up = abs( outputDirection.z ) < 0.999 ? vec3( 0.0, 0.0, 1.0 ) : vec3( 1.0, 0.0, 0.0 );
			vec3 tangent = normalize( cross( up, outputDirection ) );
			vec3 bitangent = cross( outputDirection, tangent );

			// Truncate the kernel at three standard deviations or at the antipode.
			float thetaMax = min( 3.0 * sigma, PI );
			float truncation = 1.0 - exp( - 0.5 * thetaMax * thetaMax / ( sigma * sigma ) );

			vec3 accumColor = vec3( 0.0 );
			float accumWeight = 0.0;

			for ( int i = 0; i < SAMPLES; i ++ ) {

				// Stratified inverse-CDF sampling of the Gaussian, placed on a golden-angle spiral.
				float stratum = ( float( i ) + 0.5 ) / float( SAMPLES );
				float theta = sigma * sqrt( - 2.0 * log( 1.0 - stratum * truncation ) );
				float phi = float( i ) * GOLDEN_ANGLE;

				vec3 offset = cos( phi ) * tangent + sin( phi ) * bitangent;
				vec3 sampleDirection = cos( theta ) * outputDirection + sin( theta ) * offset;

				// Correct the planar sample density to solid angle.
				float weight = sin( theta ) / theta;

				accumColor += weight * textureLod( envMap, sampleDirection, 0.0 ).rgb;
				accumWeight += weight;

			}

			gl_FragColor = vec4( accumColor / accumWeight, 1.0 );

		}
	`)}function Sp(){return fo("PMREMEquirectangularToCubemap",{envMap:{value:null}},`

		varying vec3 vWorldDirection;

		uniform sampler2D envMap;

		#include <common>

		void main() {

			// Average four subpixel samples to preserve small, bright features.
			vec3 direction = normalize( vWorldDirection );
			vec3 dx = dFdx( direction ) * 0.25;
			vec3 dy = dFdy( direction ) * 0.25;

			vec3 color = textureLod( envMap, equirectUv( normalize( direction - dx - dy ) ), 0.0 ).rgb;
			color += textureLod( envMap, equirectUv( normalize( direction + dx - dy ) ), 0.0 ).rgb;
			color += textureLod( envMap, equirectUv( normalize( direction - dx + dy ) ), 0.0 ).rgb;
			color += textureLod( envMap, equirectUv( normalize( direction + dx + dy ) ), 0.0 ).rgb;
			gl_FragColor = vec4( color * 0.25, 1.0 );

		}
	`)}function wp(){return fo("PMREMCubemapToCubemap",{envMap:{value:null},flipEnvMap:{value:-1}},`

		varying vec3 vWorldDirection;

		uniform samplerCube envMap;
		uniform float flipEnvMap;

		void main() {

			gl_FragColor = vec4( textureCube( envMap, vec3( flipEnvMap * vWorldDirection.x, vWorldDirection.yz ) ).rgb, 1.0 );

		}
	`)}function Ly(i){let t=new WeakMap,e=new WeakMap,n=null;function s(d,f=!1){return d==null?null:f?o(d):r(d)}function r(d){if(d&&d.isTexture){let f=d.mapping;if(f===rl||f===ol)if(t.has(d)){let m=t.get(d).texture;return a(m,d.mapping)}else{let m=d.image;if(m&&m.height>0){let x=new uo(m.height);return x.fromEquirectangularTexture(i,d),t.set(d,x),d.addEventListener("dispose",c),a(x.texture,d.mapping)}else return null}}return d}function o(d){if(d&&d.isTexture&&d.isPMREMTexture!==!0){let f=d.mapping,m=f===rl||f===ol,x=f===cs||f===Zs;if(m||x){let p=e.get(d),g=p!==void 0?p.texture.pmremVersion:0;if(d.isRenderTargetTexture&&d.pmremVersion!==g)return n===null&&(n=new Yl(i)),p=m?n.fromEquirectangular(d,p):n.fromCubemap(d,p),p.texture.pmremVersion=d.pmremVersion,e.set(d,p),p.texture;if(p!==void 0)return p.texture;{let y=d.image;return m&&y&&y.height>0||x&&y&&l(y)?(n===null&&(n=new Yl(i)),p=m?n.fromEquirectangular(d):n.fromCubemap(d),p.texture.pmremVersion=d.pmremVersion,e.set(d,p),d.addEventListener("dispose",h),p.texture):null}}}return d}function a(d,f){return f===rl?d.mapping=cs:f===ol&&(d.mapping=Zs),d}function l(d){let f=0,m=6;for(let x=0;x<m;x++)d[x]!==void 0&&f++;return f===m}function c(d){let f=d.target;f.removeEventListener("dispose",c);let m=t.get(f);m!==void 0&&(t.delete(f),m.dispose())}function h(d){let f=d.target;f.removeEventListener("dispose",h);let m=e.get(f);m!==void 0&&(e.delete(f),m.dispose())}function u(){t=new WeakMap,e=new WeakMap,n!==null&&(n.dispose(),n=null)}return{get:s,dispose:u}}function Dy(i){let t={};function e(n){if(t[n]!==void 0)return t[n];let s=i.getExtension(n);return t[n]=s,s}return{has:function(n){return e(n)!==null},init:function(){e("EXT_color_buffer_float"),e("WEBGL_clip_cull_distance"),e("OES_texture_float_linear"),e("EXT_color_buffer_half_float"),e("WEBGL_multisampled_render_to_texture"),e("WEBGL_render_shared_exponent")},get:function(n){let s=e(n);return s===null&&Sr("WebGLRenderer: "+n+" extension not supported."),s}}}function Ny(i,t,e,n){let s={},r=new WeakMap,o=new FinalizationRegistry(m=>delete s[m]);function a(m){l(m.target)}function l(m){m.index!==null&&t.remove(m.index);for(let p in m.attributes)t.remove(m.attributes[p]);m.removeEventListener("dispose",a),delete s[m.id],o.unregister(m);let x=r.get(m);x&&(t.remove(x),r.delete(m)),n.releaseStatesOfGeometry(m),m.isInstancedBufferGeometry===!0&&delete m._maxInstanceCount,e.memory.geometries--}function c(m,x){return s[x.id]!==void 0||(x.addEventListener("dispose",a),s[x.id]=new WeakRef(x),o.register(x,x.id,x),e.memory.geometries++),x}function h(m){let x=m.attributes;for(let p in x)t.update(x[p],i.ARRAY_BUFFER)}function u(m){let x=m.index,p=m.attributes.position,g=0;if(p===void 0)return;let y=x!==null?x.array.length:p.array.length/3-1,w=p.count>=65535?Dr:Lr,S=new w(Math.ceil(y/3)*6,1),T=S.array;if(x!==null){let _=x.array;g=x.version;for(let E=0,O=0;E<y;E+=3){let P=_[E+0],U=_[E+1],G=_[E+2];T[O++]=P,T[O++]=U,T[O++]=U,T[O++]=G,T[O++]=G,T[O++]=P}}else{g=p.version;for(let _=0,E=0;_<y;_+=3){let O=_+0,P=_+1,U=_+2;T[E++]=O,T[E++]=P,T[E++]=P,T[E++]=U,T[E++]=U,T[E++]=O}}S.version=g;let A=r.get(m);A&&t.remove(A),r.set(m,S)}function d(m){let x=r.get(m);if(x){let p=m.index;p!==null&&x.version<p.version&&u(m)}else u(m);return r.get(m)}function f(){for(let m in s){let x=s[m].deref();x!==void 0&&l(x)}}return{get:c,update:h,getWireframeAttribute:d,dispose:f}}function Uy(i,t,e){let n;function s(u){n=u}let r,o;function a(u){r=u.type,o=u.bytesPerElement}function l(u,d){i.drawElements(n,d,r,u*o),e.update(d,n,1)}function c(u,d,f){f!==0&&(i.drawElementsInstanced(n,d,r,u*o,f),e.update(d,n,f))}function h(u,d,f){if(f===0)return;t.get("WEBGL_multi_draw").multiDrawElementsWEBGL(n,d,0,r,u,0,f);let x=0;for(let p=0;p<f;p++)x+=d[p];e.update(x,n,1)}this.setMode=s,this.setIndex=a,this.render=l,this.renderInstances=c,this.renderMultiDraw=h}function Oy(i){let t={geometries:0,textures:0},e={frame:0,calls:0,triangles:0,points:0,lines:0};function n(r,o,a){switch(e.calls++,o){case i.TRIANGLES:e.triangles+=a*(r/3);break;case i.LINES:e.lines+=a*(r/2);break;case i.LINE_STRIP:e.lines+=a*(r-1);break;case i.LINE_LOOP:e.lines+=a*r;break;case i.POINTS:e.points+=a*r;break;default:Wt("WebGLInfo: Unknown draw mode:",o);break}}function s(){e.calls=0,e.triangles=0,e.points=0,e.lines=0}return{memory:t,render:e,programs:null,autoReset:!0,reset:s,update:n}}function Fy(i,t,e){let n=new WeakMap,s=new Te;function r(o,a,l){let c=o.morphTargetInfluences,h=a.morphAttributes.position||a.morphAttributes.normal||a.morphAttributes.color,u=h!==void 0?h.length:0,d=n.get(a);if(d===void 0||d.count!==u){let O=function(){_.dispose(),n.delete(a),a.removeEventListener("dispose",O)};d!==void 0&&d.texture.dispose();let f=a.morphAttributes.position!==void 0,m=a.morphAttributes.normal!==void 0,x=a.morphAttributes.color!==void 0,p=a.morphAttributes.position||[],g=a.morphAttributes.normal||[],y=a.morphAttributes.color||[],w=0;f===!0&&(w=1),m===!0&&(w=2),x===!0&&(w=3);let S=a.attributes.position.count*w,T=1;S>t.maxTextureSize&&(T=Math.ceil(S/t.maxTextureSize),S=t.maxTextureSize);let A=new Float32Array(S*T*4*u),_=new Ir(A,S,T,u);_.type=fn,_.needsUpdate=!0;let E=w*4;for(let P=0;P<u;P++){let U=p[P],G=g[P],$=y[P],L=S*T*4*P;for(let V=0;V<U.count;V++){let X=V*E;f===!0&&(s.fromBufferAttribute(U,V),A[L+X+0]=s.x,A[L+X+1]=s.y,A[L+X+2]=s.z,A[L+X+3]=0),m===!0&&(s.fromBufferAttribute(G,V),A[L+X+4]=s.x,A[L+X+5]=s.y,A[L+X+6]=s.z,A[L+X+7]=0),x===!0&&(s.fromBufferAttribute($,V),A[L+X+8]=s.x,A[L+X+9]=s.y,A[L+X+10]=s.z,A[L+X+11]=$.itemSize===4?s.w:1)}}d={count:u,texture:_,size:new rt(S,T)},n.set(a,d),a.addEventListener("dispose",O)}if(o.isInstancedMesh===!0&&o.morphTexture!==null)l.getUniforms().setValue(i,"morphTexture",o.morphTexture,e);else{let f=0;for(let x=0;x<c.length;x++)f+=c[x];let m=a.morphTargetsRelative?1:1-f;l.getUniforms().setValue(i,"morphTargetBaseInfluence",m),l.getUniforms().setValue(i,"morphTargetInfluences",c)}l.getUniforms().setValue(i,"morphTargetsTexture",d.texture,e),l.getUniforms().setValue(i,"morphTargetsTextureSize",d.size)}return{update:r}}function By(i,t,e,n,s){let r=new WeakMap;function o(c){let h=s.render.frame,u=c.geometry,d=t.get(c,u);if(r.get(d)!==h&&(t.update(d),r.set(d,h)),c.isInstancedMesh&&(c.hasEventListener("dispose",l)===!1&&c.addEventListener("dispose",l),r.get(c)!==h&&(e.update(c.instanceMatrix,i.ARRAY_BUFFER),c.instanceColor!==null&&e.update(c.instanceColor,i.ARRAY_BUFFER),r.set(c,h))),c.isSkinnedMesh){let f=c.skeleton;r.get(f)!==h&&(f.update(),r.set(f,h))}return d}function a(){r=new WeakMap}function l(c){let h=c.target;h.removeEventListener("dispose",l),n.releaseStatesOfObject(h),e.remove(h.instanceMatrix),h.instanceColor!==null&&e.remove(h.instanceColor)}return{update:o,dispose:a}}var ky={[Fh]:"LINEAR_TONE_MAPPING",[Bh]:"REINHARD_TONE_MAPPING",[kh]:"CINEON_TONE_MAPPING",[zh]:"ACES_FILMIC_TONE_MAPPING",[Vh]:"AGX_TONE_MAPPING",[Hh]:"NEUTRAL_TONE_MAPPING",[Gh]:"CUSTOM_TONE_MAPPING"};function zy(i,t,e,n,s,r){let o=new Ze(t,e,{type:i,depthBuffer:s,stencilBuffer:r,samples:n?4:0,storeMultisampledDepthBuffer:!1,storeMultisampledStencilBuffer:!1,resolveDepthBuffer:!1,resolveStencilBuffer:!1}),a=null,l=null,c=null,h=new Se;h.setAttribute("position",new ze([-1,3,0,-1,-1,0,3,-1,0],3)),h.setAttribute("uv",new ze([0,2,0,0,2,0],2));let u=new Ha({uniforms:{tDiffuse:{value:null}},vertexShader:`
			precision highp float;

			uniform mat4 modelViewMatrix;
			uniform mat4 projectionMatrix;

			attribute vec3 position;
			attribute vec2 uv;

			varying vec2 vUv;

			void main() {
				vUv = uv;
				gl_Position = projectionMatrix * modelViewMatrix * vec4( position, 1.0 );
			}`,fragmentShader:`
			precision highp float;

			uniform sampler2D tDiffuse;

			varying vec2 vUv;

			#include <tonemapping_pars_fragment>
			#include <colorspace_pars_fragment>

			void main() {
				gl_FragColor = texture2D( tDiffuse, vUv );

				#ifdef LINEAR_TONE_MAPPING
					gl_FragColor.rgb = LinearToneMapping( gl_FragColor.rgb );
				#elif defined( REINHARD_TONE_MAPPING )
					gl_FragColor.rgb = ReinhardToneMapping( gl_FragColor.rgb );
				#elif defined( CINEON_TONE_MAPPING )
					gl_FragColor.rgb = CineonToneMapping( gl_FragColor.rgb );
				#elif defined( ACES_FILMIC_TONE_MAPPING )
					gl_FragColor.rgb = ACESFilmicToneMapping( gl_FragColor.rgb );
				#elif defined( AGX_TONE_MAPPING )
					gl_FragColor.rgb = AgXToneMapping( gl_FragColor.rgb );
				#elif defined( NEUTRAL_TONE_MAPPING )
					gl_FragColor.rgb = NeutralToneMapping( gl_FragColor.rgb );
				#elif defined( CUSTOM_TONE_MAPPING )
					gl_FragColor.rgb = CustomToneMapping( gl_FragColor.rgb );
				#endif

				#ifdef SRGB_TRANSFER
					gl_FragColor = sRGBTransferOETF( gl_FragColor );
				#endif
			}`,depthTest:!1,depthWrite:!1}),d=new Ee(h,u),f=new Xs(-1,1,1,-1,0,1),m=null,x=null,p=!1,g,y=null,w=[],S=!1;this.setSize=function(T,A){o.setSize(T,A),a!==null&&a.setSize(T,A),l!==null&&l.setSize(T,A);for(let _=0;_<w.length;_++){let E=w[_];E.setSize&&E.setSize(T,A)}},this.setEffects=function(T){w=T,S=w.length>0&&w[0].isRenderPass===!0;let A=o.width,_=o.height;w.length>0&&a===null&&(a=new Ze(A,_,{type:zn,depthBuffer:!1,stencilBuffer:!1}),l=new Ze(A,_,{type:zn,depthBuffer:!1,stencilBuffer:!1}));let E=s===!0&&w.some(O=>O.needsDepthTexture===!0);E!==(o.depthTexture!==null)&&(E===!0&&c===null&&(c=new yi(A,_),r===!0&&(c.format=Mi,c.type=hs)),o.dispose(),o.depthTexture=E?c:null,o.resolveDepthBuffer=E,o.storeMultisampledDepthBuffer=E);for(let O=0;O<w.length;O++){let P=w[O];P.setSize&&P.setSize(A,_),E&&P.needsDepthTexture===!0&&P.setDepthTexture&&P.setDepthTexture(c)}},this.begin=function(T,A){if(p||T.toneMapping===ti&&w.length===0)return!1;if(y=A,A!==null){let _=A.width,E=A.height;(o.width!==_||o.height!==E)&&this.setSize(_,E)}return S===!1&&T.setRenderTarget(o),g=T.toneMapping,T.toneMapping=ti,!0},this.hasRenderPass=function(){return S},this.end=function(T,A){T.toneMapping=g,p=!0;let _=o,E=a;for(let O=0;O<w.length;O++){let P=w[O];P.enabled!==!1&&(P.render(T,E,_,A),P.needsSwap!==!1&&(_=E,E=E===a?l:a))}if(m!==T.outputColorSpace||x!==T.toneMapping){m=T.outputColorSpace,x=T.toneMapping,u.defines={},se.getTransfer(m)===_e&&(u.defines.SRGB_TRANSFER="");let O=ky[x];O&&(u.defines[O]=""),u.needsUpdate=!0}u.uniforms.tDiffuse.value=_.texture,T.setRenderTarget(y),T.render(d,f),y=null,p=!1},this.isCompositing=function(){return p},this.dispose=function(){o.dispose(),a!==null&&a.dispose(),l!==null&&l.dispose(),h.dispose(),u.dispose()}}var qp=new un,$p=new yi(1,1),Yp=new Fr(1),Zp=new Ir,Jp=new Ia,jp=new Or,Ep=[],Ap=[],Tp=new Float32Array(16),Cp=new Float32Array(9),Rp=new Float32Array(4);function Ks(i,t,e){let n=i[0];if(n<=0||n>0)return i;let s=t*e,r=Ep[s];if(r===void 0&&(r=new Float32Array(s),Ep[s]=r),t!==0){n.toArray(r,0);for(let o=1,a=0;o!==t;++o)a+=e,i[o].toArray(r,a)}return r}function Ve(i,t){if(i.length!==t.length)return!1;for(let e=0,n=i.length;e<n;e++)if(i[e]!==t[e])return!1;return!0}function He(i,t){for(let e=0,n=t.length;e<n;e++)i[e]=t[e]}function Jl(i,t){let e=Ap[t];e===void 0&&(e=new Int32Array(t),Ap[t]=e);for(let n=0;n!==t;++n)e[n]=i.allocateTextureUnit();return e}function Gy(i,t){let e=this.cache;e[0]!==t&&(i.uniform1f(this.addr,t),e[0]=t)}function Vy(i,t){let e=this.cache;if(t.x!==void 0)(e[0]!==t.x||e[1]!==t.y)&&(i.uniform2f(this.addr,t.x,t.y),e[0]=t.x,e[1]=t.y);else{if(Ve(e,t))return;i.uniform2fv(this.addr,t),He(e,t)}}function Hy(i,t){let e=this.cache;if(t.x!==void 0)(e[0]!==t.x||e[1]!==t.y||e[2]!==t.z)&&(i.uniform3f(this.addr,t.x,t.y,t.z),e[0]=t.x,e[1]=t.y,e[2]=t.z);else if(t.r!==void 0)(e[0]!==t.r||e[1]!==t.g||e[2]!==t.b)&&(i.uniform3f(this.addr,t.r,t.g,t.b),e[0]=t.r,e[1]=t.g,e[2]=t.b);else{if(Ve(e,t))return;i.uniform3fv(this.addr,t),He(e,t)}}function Wy(i,t){let e=this.cache;if(t.x!==void 0)(e[0]!==t.x||e[1]!==t.y||e[2]!==t.z||e[3]!==t.w)&&(i.uniform4f(this.addr,t.x,t.y,t.z,t.w),e[0]=t.x,e[1]=t.y,e[2]=t.z,e[3]=t.w);else{if(Ve(e,t))return;i.uniform4fv(this.addr,t),He(e,t)}}function Xy(i,t){let e=this.cache,n=t.elements;if(n===void 0){if(Ve(e,t))return;i.uniformMatrix2fv(this.addr,!1,t),He(e,t)}else{if(Ve(e,n))return;Rp.set(n),i.uniformMatrix2fv(this.addr,!1,Rp),He(e,n)}}function qy(i,t){let e=this.cache,n=t.elements;if(n===void 0){if(Ve(e,t))return;i.uniformMatrix3fv(this.addr,!1,t),He(e,t)}else{if(Ve(e,n))return;Cp.set(n),i.uniformMatrix3fv(this.addr,!1,Cp),He(e,n)}}function $y(i,t){let e=this.cache,n=t.elements;if(n===void 0){if(Ve(e,t))return;i.uniformMatrix4fv(this.addr,!1,t),He(e,t)}else{if(Ve(e,n))return;Tp.set(n),i.uniformMatrix4fv(this.addr,!1,Tp),He(e,n)}}function Yy(i,t){let e=this.cache;e[0]!==t&&(i.uniform1i(this.addr,t),e[0]=t)}function Zy(i,t){let e=this.cache;if(t.x!==void 0)(e[0]!==t.x||e[1]!==t.y)&&(i.uniform2i(this.addr,t.x,t.y),e[0]=t.x,e[1]=t.y);else{if(Ve(e,t))return;i.uniform2iv(this.addr,t),He(e,t)}}function Jy(i,t){let e=this.cache;if(t.x!==void 0)(e[0]!==t.x||e[1]!==t.y||e[2]!==t.z)&&(i.uniform3i(this.addr,t.x,t.y,t.z),e[0]=t.x,e[1]=t.y,e[2]=t.z);else{if(Ve(e,t))return;i.uniform3iv(this.addr,t),He(e,t)}}function jy(i,t){let e=this.cache;if(t.x!==void 0)(e[0]!==t.x||e[1]!==t.y||e[2]!==t.z||e[3]!==t.w)&&(i.uniform4i(this.addr,t.x,t.y,t.z,t.w),e[0]=t.x,e[1]=t.y,e[2]=t.z,e[3]=t.w);else{if(Ve(e,t))return;i.uniform4iv(this.addr,t),He(e,t)}}function Ky(i,t){let e=this.cache;e[0]!==t&&(i.uniform1ui(this.addr,t),e[0]=t)}function Qy(i,t){let e=this.cache;if(t.x!==void 0)(e[0]!==t.x||e[1]!==t.y)&&(i.uniform2ui(this.addr,t.x,t.y),e[0]=t.x,e[1]=t.y);else{if(Ve(e,t))return;i.uniform2uiv(this.addr,t),He(e,t)}}function tb(i,t){let e=this.cache;if(t.x!==void 0)(e[0]!==t.x||e[1]!==t.y||e[2]!==t.z)&&(i.uniform3ui(this.addr,t.x,t.y,t.z),e[0]=t.x,e[1]=t.y,e[2]=t.z);else{if(Ve(e,t))return;i.uniform3uiv(this.addr,t),He(e,t)}}function eb(i,t){let e=this.cache;if(t.x!==void 0)(e[0]!==t.x||e[1]!==t.y||e[2]!==t.z||e[3]!==t.w)&&(i.uniform4ui(this.addr,t.x,t.y,t.z,t.w),e[0]=t.x,e[1]=t.y,e[2]=t.z,e[3]=t.w);else{if(Ve(e,t))return;i.uniform4uiv(this.addr,t),He(e,t)}}function jl(i){return i.version===0&&(i.compareFunction=iu,i.needsUpdate=!0),i}function nb(i,t,e){let n=this.cache,s=e.allocateTextureUnit();n[0]!==s&&(i.uniform1i(this.addr,s),n[0]=s);let r;this.type===i.SAMPLER_2D_SHADOW?r=jl($p):r=qp,e.setTexture2D(t||r,s)}function ib(i,t,e){let n=this.cache,s=e.allocateTextureUnit();n[0]!==s&&(i.uniform1i(this.addr,s),n[0]=s),e.setTexture3D(t||Jp,s)}function sb(i,t,e){let n=this.cache,s=e.allocateTextureUnit();n[0]!==s&&(i.uniform1i(this.addr,s),n[0]=s);let r;this.type===i.SAMPLER_CUBE_SHADOW?r=jl(Yp):r=jp,e.setTextureCube(t||r,s)}function rb(i,t,e){let n=this.cache,s=e.allocateTextureUnit();n[0]!==s&&(i.uniform1i(this.addr,s),n[0]=s),e.setTexture2DArray(t||Zp,s)}function ob(i){switch(i){case 5126:return Gy;case 35664:return Vy;case 35665:return Hy;case 35666:return Wy;case 35674:return Xy;case 35675:return qy;case 35676:return $y;case 5124:case 35670:return Yy;case 35667:case 35671:return Zy;case 35668:case 35672:return Jy;case 35669:case 35673:return jy;case 5125:return Ky;case 36294:return Qy;case 36295:return tb;case 36296:return eb;case 35678:case 36198:case 36298:case 36306:case 35682:return nb;case 35679:case 36299:case 36307:return ib;case 35680:case 36300:case 36308:case 36293:return sb;case 36289:case 36303:case 36311:case 36292:return rb}}function ab(i,t){i.uniform1fv(this.addr,t)}function lb(i,t){let e=Ks(t,this.size,2);i.uniform2fv(this.addr,e)}function cb(i,t){let e=Ks(t,this.size,3);i.uniform3fv(this.addr,e)}function hb(i,t){let e=Ks(t,this.size,4);i.uniform4fv(this.addr,e)}function ub(i,t){let e=Ks(t,this.size,4);i.uniformMatrix2fv(this.addr,!1,e)}function db(i,t){let e=Ks(t,this.size,9);i.uniformMatrix3fv(this.addr,!1,e)}function fb(i,t){let e=Ks(t,this.size,16);i.uniformMatrix4fv(this.addr,!1,e)}function pb(i,t){i.uniform1iv(this.addr,t)}function mb(i,t){i.uniform2iv(this.addr,t)}function gb(i,t){i.uniform3iv(this.addr,t)}function _b(i,t){i.uniform4iv(this.addr,t)}function xb(i,t){i.uniform1uiv(this.addr,t)}function vb(i,t){i.uniform2uiv(this.addr,t)}function yb(i,t){i.uniform3uiv(this.addr,t)}function bb(i,t){i.uniform4uiv(this.addr,t)}function Mb(i,t,e){let n=this.cache,s=t.length,r=Jl(e,s);Ve(n,r)||(i.uniform1iv(this.addr,r),He(n,r));let o;this.type===i.SAMPLER_2D_SHADOW?o=jl($p):o=qp;for(let a=0;a!==s;++a)e.setTexture2D(t[a]||o,r[a])}function Sb(i,t,e){let n=this.cache,s=t.length,r=Jl(e,s);Ve(n,r)||(i.uniform1iv(this.addr,r),He(n,r));for(let o=0;o!==s;++o)e.setTexture3D(t[o]||Jp,r[o])}function wb(i,t,e){let n=this.cache,s=t.length,r=Jl(e,s);Ve(n,r)||(i.uniform1iv(this.addr,r),He(n,r));let o;this.type===i.SAMPLER_CUBE_SHADOW?o=jl(Yp):o=jp;for(let a=0;a!==s;++a)e.setTextureCube(t[a]||o,r[a])}function Eb(i,t,e){let n=this.cache,s=t.length,r=Jl(e,s);Ve(n,r)||(i.uniform1iv(this.addr,r),He(n,r));for(let o=0;o!==s;++o)e.setTexture2DArray(t[o]||Zp,r[o])}function Ab(i){switch(i){case 5126:return ab;case 35664:return lb;case 35665:return cb;case 35666:return hb;case 35674:return ub;case 35675:return db;case 35676:return fb;case 5124:case 35670:return pb;case 35667:case 35671:return mb;case 35668:case 35672:return gb;case 35669:case 35673:return _b;case 5125:return xb;case 36294:return vb;case 36295:return yb;case 36296:return bb;case 35678:case 36198:case 36298:case 36306:case 35682:return Mb;case 35679:case 36299:case 36307:return Sb;case 35680:case 36300:case 36308:case 36293:return wb;case 36289:case 36303:case 36311:case 36292:return Eb}}var gu=class{constructor(t,e,n){this.id=t,this.addr=n,this.cache=[],this.type=e.type,this.setValue=ob(e.type)}},_u=class{constructor(t,e,n){this.id=t,this.addr=n,this.cache=[],this.type=e.type,this.size=e.size,this.setValue=Ab(e.type)}},xu=class{constructor(t){this.id=t,this.seq=[],this.map={}}setValue(t,e,n){let s=this.seq;for(let r=0,o=s.length;r!==o;++r){let a=s[r];a.setValue(t,e[a.id],n)}}},pu=/(\w+)(\])?(\[|\.)?/g;function Pp(i,t){i.seq.push(t),i.map[t.id]=t}function Tb(i,t,e){let n=i.name,s=n.length;for(pu.lastIndex=0;;){let r=pu.exec(n),o=pu.lastIndex,a=r[1],l=r[2]==="]",c=r[3];if(l&&(a=a|0),c===void 0||c==="["&&o+2===s){Pp(e,c===void 0?new gu(a,i,t):new _u(a,i,t));break}else{let u=e.map[a];u===void 0&&(u=new xu(a),Pp(e,u)),e=u}}}var js=class{constructor(t,e){this.seq=[],this.map={};let n=t.getProgramParameter(e,t.ACTIVE_UNIFORMS);for(let o=0;o<n;++o){let a=t.getActiveUniform(e,o),l=t.getUniformLocation(e,a.name);Tb(a,l,this)}let s=[],r=[];for(let o of this.seq)o.type===t.SAMPLER_2D_SHADOW||o.type===t.SAMPLER_CUBE_SHADOW||o.type===t.SAMPLER_2D_ARRAY_SHADOW?s.push(o):r.push(o);s.length>0&&(this.seq=s.concat(r))}setValue(t,e,n,s){let r=this.map[e];r!==void 0&&r.setValue(t,n,s)}setOptional(t,e,n){let s=e[n];s!==void 0&&this.setValue(t,n,s)}static upload(t,e,n,s){for(let r=0,o=e.length;r!==o;++r){let a=e[r],l=n[a.id];l.needsUpdate!==!1&&a.setValue(t,l.value,s)}}static seqWithValue(t,e){let n=[];for(let s=0,r=t.length;s!==r;++s){let o=t[s];o.id in e&&n.push(o)}return n}};function Ip(i,t,e){let n=i.createShader(t);return i.shaderSource(n,e),i.compileShader(n),n}var Cb=37297,Rb=0;function Pb(i,t){let e=i.split(`
`),n=[],s=Math.max(t-6,0),r=Math.min(t+6,e.length);for(let o=s;o<r;o++){let a=o+1;n.push(`${a===t?">":" "} ${a}: ${e[o]}`)}return n.join(`
`)}var Lp=new $t;function Ib(i){se._getMatrix(Lp,se.workingColorSpace,i);let t=`mat3( ${Lp.elements.map(e=>e.toFixed(4))} )`;switch(se.getTransfer(i)){case Cr:return[t,"LinearTransferOETF"];case _e:return[t,"sRGBTransferOETF"];default:return Vt("WebGLProgram: Unsupported color space: ",i),[t,"LinearTransferOETF"]}}function Dp(i,t,e){let n=i.getShaderParameter(t,i.COMPILE_STATUS),r=(i.getShaderInfoLog(t)||"").trim();if(n&&r==="")return"";let o=/ERROR: 0:(\d+)/.exec(r);if(o){let a=parseInt(o[1]);return e.toUpperCase()+`

`+r+`

`+Pb(i.getShaderSource(t),a)}else return r}function Lb(i,t){let e=Ib(t);return[`vec4 ${i}( vec4 value ) {`,`	return ${e[1]}( vec4( ${e[0]} * value.rgb, value.a ) );`,"}"].join(`
`)}var Db={[Fh]:"Linear",[Bh]:"Reinhard",[kh]:"Cineon",[zh]:"ACESFilmic",[Vh]:"AgX",[Hh]:"Neutral",[Gh]:"Custom"};function Nb(i,t){let e=Db[t];return e===void 0?(Vt("WebGLProgram: Unsupported toneMapping:",t),"vec3 "+i+"( vec3 color ) { return LinearToneMapping( color ); }"):"vec3 "+i+"( vec3 color ) { return "+e+"ToneMapping( color ); }"}var $l=new I;function Ub(){se.getLuminanceCoefficients($l);let i=$l.x.toFixed(4),t=$l.y.toFixed(4),e=$l.z.toFixed(4);return["float luminance( const in vec3 rgb ) {",`	const vec3 weights = vec3( ${i}, ${t}, ${e} );`,"	return dot( weights, rgb );","}"].join(`
`)}function Ob(i){return[i.extensionClipCullDistance?"#extension GL_ANGLE_clip_cull_distance : require":"",i.extensionMultiDraw?"#extension GL_ANGLE_multi_draw : require":""].filter(ho).join(`
`)}function Fb(i){let t=[];for(let e in i){let n=i[e];n!==!1&&t.push("#define "+e+" "+n)}return t.join(`
`)}function Bb(i,t){let e={},n=i.getProgramParameter(t,i.ACTIVE_ATTRIBUTES);for(let s=0;s<n;s++){let r=i.getActiveAttrib(t,s),o=r.name,a=1;r.type===i.FLOAT_MAT2&&(a=2),r.type===i.FLOAT_MAT3&&(a=3),r.type===i.FLOAT_MAT4&&(a=4),e[o]={type:r.type,location:i.getAttribLocation(t,o),locationSize:a}}return e}function ho(i){return i!==""}function Np(i,t){let e=t.numSpotLightShadows+t.numSpotLightMaps-t.numSpotLightShadowsWithMaps;return i.replace(/NUM_SUN_LIGHTS/g,t.numSunLights).replace(/NUM_DIR_LIGHTS/g,t.numDirLights).replace(/NUM_SPOT_LIGHTS/g,t.numSpotLights).replace(/NUM_SPOT_LIGHT_MAPS/g,t.numSpotLightMaps).replace(/NUM_SPOT_LIGHT_COORDS/g,e).replace(/NUM_RECT_AREA_LIGHTS/g,t.numRectAreaLights).replace(/NUM_POINT_LIGHTS/g,t.numPointLights).replace(/NUM_HEMI_LIGHTS/g,t.numHemiLights).replace(/NUM_SUN_LIGHT_SHADOWS/g,t.numSunLightShadows).replace(/NUM_DIR_LIGHT_SHADOWS/g,t.numDirLightShadows).replace(/NUM_SPOT_LIGHT_SHADOWS_WITH_MAPS/g,t.numSpotLightShadowsWithMaps).replace(/NUM_SPOT_LIGHT_SHADOWS/g,t.numSpotLightShadows).replace(/NUM_POINT_LIGHT_SHADOWS/g,t.numPointLightShadows).replace(/NUM_LIGHT_PROBE_GRIDS/g,t.numLightProbeGrids)}function Up(i,t){return i.replace(/NUM_CLIPPING_PLANES/g,t.numClippingPlanes).replace(/UNION_CLIPPING_PLANES/g,t.numClippingPlanes-t.numClipIntersection)}var kb=/^[ \t]*#include +<([\w\d./]+)>/gm;function vu(i){return i.replace(kb,zb)}function zb(i,t){let e=ne[t];if(e===void 0)throw new Error("THREE.WebGLProgram: Can not resolve #include <"+t+">");return vu(e)}var Gb=/#pragma unroll_loop_start\s+for\s*\(\s*int\s+i\s*=\s*(\d+)\s*;\s*i\s*<\s*(\d+)\s*;\s*i\s*\+\+\s*\)\s*{([\s\S]+?)}\s+#pragma unroll_loop_end/g;function Op(i){return i.replace(Gb,Vb)}function Vb(i,t,e,n){let s="";for(let r=parseInt(t);r<parseInt(e);r++)s+=n.replace(/\[\s*i\s*\]/g,"[ "+r+" ]").replace(/UNROLLED_LOOP_INDEX/g,r);return s}function Fp(i){let t=`precision ${i.precision} float;
	precision ${i.precision} int;
	precision ${i.precision} sampler2D;
	precision ${i.precision} samplerCube;
	precision ${i.precision} sampler3D;
	precision ${i.precision} sampler2DArray;
	precision ${i.precision} sampler2DShadow;
	precision ${i.precision} samplerCubeShadow;
	precision ${i.precision} sampler2DArrayShadow;
	precision ${i.precision} isampler2D;
	precision ${i.precision} isampler3D;
	precision ${i.precision} isamplerCube;
	precision ${i.precision} isampler2DArray;
	precision ${i.precision} usampler2D;
	precision ${i.precision} usampler3D;
	precision ${i.precision} usamplerCube;
	precision ${i.precision} usampler2DArray;
	`;return i.precision==="highp"?t+=`
#define HIGH_PRECISION`:i.precision==="mediump"?t+=`
#define MEDIUM_PRECISION`:i.precision==="lowp"&&(t+=`
#define LOW_PRECISION`),t}var Hb={[to]:"SHADOWMAP_TYPE_PCF",[$s]:"SHADOWMAP_TYPE_VSM"};function Wb(i){return Hb[i.shadowMapType]||"SHADOWMAP_TYPE_BASIC"}var Xb={[Zs]:"ENVMAP_MODE_REFRACTION"};function qb(i){return i.envMap===!1?"ENVMAP_MODE_REFLECTION":Xb[i.envMapMode]||"ENVMAP_MODE_REFLECTION"}var $b={[Oh]:"ENVMAP_BLENDING_MULTIPLY",[Jf]:"ENVMAP_BLENDING_MIX",[jf]:"ENVMAP_BLENDING_ADD"};function Yb(i){return i.envMap===!1?"ENVMAP_BLENDING_NONE":$b[i.combine]||"ENVMAP_BLENDING_NONE"}function Zb(i,t,e,n){let s=i.getContext(),r=e.defines,o=e.vertexShader,a=e.fragmentShader,l=Wb(e),c=e.envMapPMREM===!0?"ENVMAP_TYPE_PMREM":"ENVMAP_TYPE_CUBE",h=qb(e),u=Yb(e),d=Ob(e),f=Fb(r),m=s.createProgram(),x,p,g=e.glslVersion?"#version "+e.glslVersion+`
`:"";e.isRawShaderMaterial?(x=["#define SHADER_TYPE "+e.shaderType,"#define SHADER_NAME "+e.shaderName,f].filter(ho).join(`
`),x.length>0&&(x+=`
`),p=["#define SHADER_TYPE "+e.shaderType,"#define SHADER_NAME "+e.shaderName,f].filter(ho).join(`
`),p.length>0&&(p+=`
`)):(x=[Fp(e),"#define SHADER_TYPE "+e.shaderType,"#define SHADER_NAME "+e.shaderName,f,e.extensionClipCullDistance?"#define USE_CLIP_DISTANCE":"",e.batching?"#define USE_BATCHING":"",e.batchingColor?"#define USE_BATCHING_COLOR":"",e.instancing?"#define USE_INSTANCING":"",e.instancingColor?"#define USE_INSTANCING_COLOR":"",e.instancingMorph?"#define USE_INSTANCING_MORPH":"",e.useFog&&e.fog?"#define USE_FOG":"",e.useFog&&e.fogExp2?"#define FOG_EXP2":"",e.map?"#define USE_MAP":"",e.envMap?"#define USE_ENVMAP":"",e.envMap?"#define "+h:"",e.lightMap?"#define USE_LIGHTMAP":"",e.aoMap?"#define USE_AOMAP":"",e.bumpMap?"#define USE_BUMPMAP":"",e.normalMap?"#define USE_NORMALMAP":"",e.normalMapObjectSpace?"#define USE_NORMALMAP_OBJECTSPACE":"",e.normalMapTangentSpace?"#define USE_NORMALMAP_TANGENTSPACE":"",e.displacementMap?"#define USE_DISPLACEMENTMAP":"",e.emissiveMap?"#define USE_EMISSIVEMAP":"",e.anisotropy?"#define USE_ANISOTROPY":"",e.anisotropyMap?"#define USE_ANISOTROPYMAP":"",e.clearcoatMap?"#define USE_CLEARCOATMAP":"",e.clearcoatRoughnessMap?"#define USE_CLEARCOAT_ROUGHNESSMAP":"",e.clearcoatNormalMap?"#define USE_CLEARCOAT_NORMALMAP":"",e.diffuseRoughnessMap?"#define USE_DIFFUSE_ROUGHNESSMAP":"",e.iridescenceMap?"#define USE_IRIDESCENCEMAP":"",e.iridescenceThicknessMap?"#define USE_IRIDESCENCE_THICKNESSMAP":"",e.specularMap?"#define USE_SPECULARMAP":"",e.specularColorMap?"#define USE_SPECULAR_COLORMAP":"",e.specularIntensityMap?"#define USE_SPECULAR_INTENSITYMAP":"",e.roughnessMap?"#define USE_ROUGHNESSMAP":"",e.metalnessMap?"#define USE_METALNESSMAP":"",e.alphaMap?"#define USE_ALPHAMAP":"",e.alphaHash?"#define USE_ALPHAHASH":"",e.transmission?"#define USE_TRANSMISSION":"",e.transmissionMap?"#define USE_TRANSMISSIONMAP":"",e.thicknessMap?"#define USE_THICKNESSMAP":"",e.sheenColorMap?"#define USE_SHEEN_COLORMAP":"",e.sheenRoughnessMap?"#define USE_SHEEN_ROUGHNESSMAP":"",e.mapUv?"#define MAP_UV "+e.mapUv:"",e.alphaMapUv?"#define ALPHAMAP_UV "+e.alphaMapUv:"",e.lightMapUv?"#define LIGHTMAP_UV "+e.lightMapUv:"",e.aoMapUv?"#define AOMAP_UV "+e.aoMapUv:"",e.emissiveMapUv?"#define EMISSIVEMAP_UV "+e.emissiveMapUv:"",e.bumpMapUv?"#define BUMPMAP_UV "+e.bumpMapUv:"",e.normalMapUv?"#define NORMALMAP_UV "+e.normalMapUv:"",e.displacementMapUv?"#define DISPLACEMENTMAP_UV "+e.displacementMapUv:"",e.metalnessMapUv?"#define METALNESSMAP_UV "+e.metalnessMapUv:"",e.roughnessMapUv?"#define ROUGHNESSMAP_UV "+e.roughnessMapUv:"",e.anisotropyMapUv?"#define ANISOTROPYMAP_UV "+e.anisotropyMapUv:"",e.clearcoatMapUv?"#define CLEARCOATMAP_UV "+e.clearcoatMapUv:"",e.clearcoatNormalMapUv?"#define CLEARCOAT_NORMALMAP_UV "+e.clearcoatNormalMapUv:"",e.clearcoatRoughnessMapUv?"#define CLEARCOAT_ROUGHNESSMAP_UV "+e.clearcoatRoughnessMapUv:"",e.diffuseRoughnessMapUv?"#define DIFFUSE_ROUGHNESSMAP_UV "+e.diffuseRoughnessMapUv:"",e.iridescenceMapUv?"#define IRIDESCENCEMAP_UV "+e.iridescenceMapUv:"",e.iridescenceThicknessMapUv?"#define IRIDESCENCE_THICKNESSMAP_UV "+e.iridescenceThicknessMapUv:"",e.sheenColorMapUv?"#define SHEEN_COLORMAP_UV "+e.sheenColorMapUv:"",e.sheenRoughnessMapUv?"#define SHEEN_ROUGHNESSMAP_UV "+e.sheenRoughnessMapUv:"",e.specularMapUv?"#define SPECULARMAP_UV "+e.specularMapUv:"",e.specularColorMapUv?"#define SPECULAR_COLORMAP_UV "+e.specularColorMapUv:"",e.specularIntensityMapUv?"#define SPECULAR_INTENSITYMAP_UV "+e.specularIntensityMapUv:"",e.transmissionMapUv?"#define TRANSMISSIONMAP_UV "+e.transmissionMapUv:"",e.thicknessMapUv?"#define THICKNESSMAP_UV "+e.thicknessMapUv:"",e.vertexTangents&&e.flatShading===!1?"#define USE_TANGENT":"",e.vertexNormals?"#define HAS_NORMAL":"",e.vertexColors?"#define USE_COLOR":"",e.vertexAlphas?"#define USE_COLOR_ALPHA":"",e.vertexUv1s?"#define USE_UV1":"",e.vertexUv2s?"#define USE_UV2":"",e.vertexUv3s?"#define USE_UV3":"",e.pointsUvs?"#define USE_POINTS_UV":"",e.flatShading?"#define FLAT_SHADED":"",e.skinning?"#define USE_SKINNING":"",e.morphTargets?"#define USE_MORPHTARGETS":"",e.morphNormals&&e.flatShading===!1?"#define USE_MORPHNORMALS":"",e.morphColors?"#define USE_MORPHCOLORS":"",e.morphTargetsCount>0?"#define MORPHTARGETS_TEXTURE_STRIDE "+e.morphTextureStride:"",e.morphTargetsCount>0?"#define MORPHTARGETS_COUNT "+e.morphTargetsCount:"",e.doubleSided?"#define DOUBLE_SIDED":"",e.flipSided?"#define FLIP_SIDED":"",e.shadowMapEnabled?"#define USE_SHADOWMAP":"",e.shadowMapEnabled?"#define "+l:"",e.sizeAttenuation?"#define USE_SIZEATTENUATION":"",e.numLightProbes>0?"#define USE_LIGHT_PROBES":"",e.logarithmicDepthBuffer?"#define USE_LOGARITHMIC_DEPTH_BUFFER":"",e.reversedDepthBuffer?"#define USE_REVERSED_DEPTH_BUFFER":"","uniform mat4 modelMatrix;","uniform mat4 modelViewMatrix;","uniform mat4 projectionMatrix;","uniform mat4 viewMatrix;","uniform mat3 normalMatrix;","uniform vec3 cameraPosition;","uniform bool isOrthographic;","#ifdef USE_INSTANCING","	attribute mat4 instanceMatrix;","#endif","#ifdef USE_INSTANCING_COLOR","	attribute vec3 instanceColor;","#endif","#ifdef USE_INSTANCING_MORPH","	uniform sampler2D morphTexture;","#endif","attribute vec3 position;","attribute vec3 normal;","attribute vec2 uv;","#ifdef USE_UV1","	attribute vec2 uv1;","#endif","#ifdef USE_UV2","	attribute vec2 uv2;","#endif","#ifdef USE_UV3","	attribute vec2 uv3;","#endif","#ifdef USE_TANGENT","	attribute vec4 tangent;","#endif","#if defined( USE_COLOR_ALPHA )","	attribute vec4 color;","#elif defined( USE_COLOR )","	attribute vec3 color;","#endif","#ifdef USE_SKINNING","	attribute vec4 skinIndex;","	attribute vec4 skinWeight;","#endif",`
`].filter(ho).join(`
`),p=[Fp(e),"#define SHADER_TYPE "+e.shaderType,"#define SHADER_NAME "+e.shaderName,f,e.useFog&&e.fog?"#define USE_FOG":"",e.useFog&&e.fogExp2?"#define FOG_EXP2":"",e.alphaToCoverage?"#define ALPHA_TO_COVERAGE":"",e.map?"#define USE_MAP":"",e.matcap?"#define USE_MATCAP":"",e.envMap?"#define USE_ENVMAP":"",e.envMap?"#define "+c:"",e.envMap?"#define "+h:"",e.envMap?"#define "+u:"",e.envMapPMREM?"#define ENVMAP_MAX_LOD "+e.envMapMaxLod+".0":"",e.envMapPMREM?"#define ENVMAP_SIZE "+e.envMapSize+".0":"",e.lightMap?"#define USE_LIGHTMAP":"",e.aoMap?"#define USE_AOMAP":"",e.bumpMap?"#define USE_BUMPMAP":"",e.normalMap?"#define USE_NORMALMAP":"",e.normalMapObjectSpace?"#define USE_NORMALMAP_OBJECTSPACE":"",e.normalMapTangentSpace?"#define USE_NORMALMAP_TANGENTSPACE":"",e.packedNormalMap?"#define USE_PACKED_NORMALMAP":"",e.emissiveMap?"#define USE_EMISSIVEMAP":"",e.anisotropy?"#define USE_ANISOTROPY":"",e.anisotropyMap?"#define USE_ANISOTROPYMAP":"",e.clearcoat?"#define USE_CLEARCOAT":"",e.clearcoatMap?"#define USE_CLEARCOATMAP":"",e.clearcoatRoughnessMap?"#define USE_CLEARCOAT_ROUGHNESSMAP":"",e.clearcoatNormalMap?"#define USE_CLEARCOAT_NORMALMAP":"",e.diffuseRoughness?"#define USE_DIFFUSE_ROUGHNESS":"",e.diffuseRoughnessMap?"#define USE_DIFFUSE_ROUGHNESSMAP":"",e.dispersion?"#define USE_DISPERSION":"",e.retroreflection?"#define USE_RETROREFLECTION":"",e.iridescence?"#define USE_IRIDESCENCE":"",e.iridescenceMap?"#define USE_IRIDESCENCEMAP":"",e.iridescenceThicknessMap?"#define USE_IRIDESCENCE_THICKNESSMAP":"",e.specularMap?"#define USE_SPECULARMAP":"",e.specularColorMap?"#define USE_SPECULAR_COLORMAP":"",e.specularIntensityMap?"#define USE_SPECULAR_INTENSITYMAP":"",e.roughnessMap?"#define USE_ROUGHNESSMAP":"",e.metalnessMap?"#define USE_METALNESSMAP":"",e.alphaMap?"#define USE_ALPHAMAP":"",e.alphaTest?"#define USE_ALPHATEST":"",e.alphaHash?"#define USE_ALPHAHASH":"",e.sheen?"#define USE_SHEEN":"",e.sheenColorMap?"#define USE_SHEEN_COLORMAP":"",e.sheenRoughnessMap?"#define USE_SHEEN_ROUGHNESSMAP":"",e.transmission?"#define USE_TRANSMISSION":"",e.transmissionMap?"#define USE_TRANSMISSIONMAP":"",e.thicknessMap?"#define USE_THICKNESSMAP":"",e.vertexTangents&&e.flatShading===!1?"#define USE_TANGENT":"",e.vertexColors||e.instancingColor?"#define USE_COLOR":"",e.vertexAlphas||e.batchingColor?"#define USE_COLOR_ALPHA":"",e.vertexUv1s?"#define USE_UV1":"",e.vertexUv2s?"#define USE_UV2":"",e.vertexUv3s?"#define USE_UV3":"",e.pointsUvs?"#define USE_POINTS_UV":"",e.gradientMap?"#define USE_GRADIENTMAP":"",e.flatShading?"#define FLAT_SHADED":"",e.doubleSided?"#define DOUBLE_SIDED":"",e.flipSided?"#define FLIP_SIDED":"",e.shadowMapEnabled?"#define USE_SHADOWMAP":"",e.shadowMapEnabled?"#define "+l:"",e.premultipliedAlpha?"#define PREMULTIPLIED_ALPHA":"",e.numLightProbes>0?"#define USE_LIGHT_PROBES":"",e.decodeVideoTexture?"#define DECODE_VIDEO_TEXTURE":"",e.decodeVideoTextureEmissive?"#define DECODE_VIDEO_TEXTURE_EMISSIVE":"",e.logarithmicDepthBuffer?"#define USE_LOGARITHMIC_DEPTH_BUFFER":"",e.reversedDepthBuffer?"#define USE_REVERSED_DEPTH_BUFFER":"","uniform mat4 viewMatrix;","uniform vec3 cameraPosition;","uniform bool isOrthographic;",e.toneMapping!==ti?"#define TONE_MAPPING":"",e.toneMapping!==ti?ne.tonemapping_pars_fragment:"",e.toneMapping!==ti?Nb("toneMapping",e.toneMapping):"",e.dithering?"#define DITHERING":"",e.opaque?"#define OPAQUE":"",ne.colorspace_pars_fragment,Lb("linearToOutputTexel",e.outputColorSpace),Ub(),e.useDepthPacking?"#define DEPTH_PACKING "+e.depthPacking:"",`
`].filter(ho).join(`
`)),o=vu(o),o=Np(o,e),o=Up(o,e),a=vu(a),a=Np(a,e),a=Up(a,e),o=Op(o),a=Op(a),e.isRawShaderMaterial!==!0&&(g=`#version 300 es
`,x=[d,"#define attribute in","#define varying out","#define texture2D texture"].join(`
`)+`
`+x,p=["#define varying in",e.glslVersion===Gn?"":"layout(location = 0) out highp vec4 pc_fragColor;",e.glslVersion===Gn?"":"#define gl_FragColor pc_fragColor","#define gl_FragDepthEXT gl_FragDepth","#define texture2D texture","#define textureCube texture","#define texture2DProj textureProj","#define texture2DLodEXT textureLod","#define texture2DProjLodEXT textureProjLod","#define textureCubeLodEXT textureLod","#define texture2DGradEXT textureGrad","#define texture2DProjGradEXT textureProjGrad","#define textureCubeGradEXT textureGrad"].join(`
`)+`
`+p);let y=g+x+o,w=g+p+a,S=Ip(s,s.VERTEX_SHADER,y),T=Ip(s,s.FRAGMENT_SHADER,w);s.attachShader(m,S),s.attachShader(m,T),e.index0AttributeName!==void 0?s.bindAttribLocation(m,0,e.index0AttributeName):e.hasPositionAttribute===!0&&s.bindAttribLocation(m,0,"position"),s.linkProgram(m);function A(P){if(i.debug.checkShaderErrors){let U=s.getProgramInfoLog(m)||"",G=s.getShaderInfoLog(S)||"",$=s.getShaderInfoLog(T)||"",L=U.trim(),V=G.trim(),X=$.trim(),z=!0,nt=!0;if(s.getProgramParameter(m,s.LINK_STATUS)===!1)if(z=!1,typeof i.debug.onShaderError=="function")i.debug.onShaderError(s,m,S,T);else{let H=Dp(s,S,"vertex"),Q=Dp(s,T,"fragment");Wt("WebGLProgram: Shader Error "+s.getError()+" - VALIDATE_STATUS "+s.getProgramParameter(m,s.VALIDATE_STATUS)+`

Material Name: `+P.name+`
Material Type: `+P.type+`

Program Info Log: `+L+`
`+H+`
`+Q)}else L!==""?Vt("WebGLProgram: Program Info Log:",L):(V===""||X==="")&&(nt=!1);nt&&(P.diagnostics={runnable:z,programLog:L,vertexShader:{log:V,prefix:x},fragmentShader:{log:X,prefix:p}})}s.deleteShader(S),s.deleteShader(T),_=new js(s,m),E=Bb(s,m)}let _;this.getUniforms=function(){return _===void 0&&A(this),_};let E;this.getAttributes=function(){return E===void 0&&A(this),E};let O=e.rendererExtensionParallelShaderCompile===!1;return this.isReady=function(){return O===!1&&(O=s.getProgramParameter(m,Cb)),O},this.destroy=function(){n.releaseStatesOfProgram(this),s.deleteProgram(m),this.program=void 0},this.type=e.shaderType,this.name=e.shaderName,this.id=Rb++,this.cacheKey=t,this.usedTimes=1,this.program=m,this.vertexShader=S,this.fragmentShader=T,this}var Jb=0,yu=class{constructor(){this.shaderCache=new Map,this.materialCache=new Map}update(t,e,n){let s=this._getShaderCacheForMaterial(t);return s.has(e)===!1&&(s.add(e),e.usedTimes++),s.has(n)===!1&&(s.add(n),n.usedTimes++),this}remove(t){let e=this.materialCache.get(t);for(let n of e)n.usedTimes--,n.usedTimes===0&&this.shaderCache.delete(n.code);return this.materialCache.delete(t),this}getVertexShaderStage(t){return this._getShaderStage(t.vertexShader)}getFragmentShaderStage(t){return this._getShaderStage(t.fragmentShader)}dispose(){this.shaderCache.clear(),this.materialCache.clear()}_getShaderCacheForMaterial(t){let e=this.materialCache,n=e.get(t);return n===void 0&&(n=new Set,e.set(t,n)),n}_getShaderStage(t){let e=this.shaderCache,n=e.get(t);return n===void 0&&(n=new bu(t),e.set(t,n)),n}},bu=class{constructor(t){this.id=Jb++,this.code=t,this.usedTimes=0}};function jb(i){return i===Wi||i===ao||i===lo}function Kb(i,t,e,n,s,r){let o=new ks,a=new yu,l=new Set,c=[],h=new Map,u=n.logarithmicDepthBuffer,d={MeshDepthMaterial:"depth",MeshDistanceMaterial:"distance",MeshNormalMaterial:"normal",MeshBasicMaterial:"basic",MeshLambertMaterial:"lambert",MeshPhongMaterial:"phong",MeshToonMaterial:"toon",MeshStandardMaterial:"physical",MeshPhysicalMaterial:"physical",MeshMatcapMaterial:"matcap",LineBasicMaterial:"basic",LineDashedMaterial:"dashed",PointsMaterial:"points",ShadowMaterial:"shadow",SpriteMaterial:"sprite"};function f(_){return l.add(_),_===0?"uv":`uv${_}`}function m(_,E,O,P,U,G){let $=P.fog,L=U.geometry,V=_.isMeshStandardMaterial||_.isMeshLambertMaterial||_.isMeshPhongMaterial?P.environment:null,X=_.isMeshStandardMaterial||_.isMeshLambertMaterial&&!_.envMap||_.isMeshPhongMaterial&&!_.envMap,z=t.get(_.envMap||V,X),nt=d[_.type],H=n.precision;_.precision!==null&&(H=n.getMaxPrecision(_.precision),H!==_.precision&&Vt("WebGLProgram.getParameters:",_.precision,"not supported, using",H,"instead."));let Q=L.morphAttributes.position||L.morphAttributes.normal||L.morphAttributes.color,et=Q!==void 0?Q.length:0,Et=0;L.morphAttributes.position!==void 0&&(Et=1),L.morphAttributes.normal!==void 0&&(Et=2),L.morphAttributes.color!==void 0&&(Et=3);let Nt,Y,ht,At;if(nt){let bt=ni[nt];Nt=bt.vertexShader,Y=bt.fragmentShader}else{Nt=_.vertexShader,Y=_.fragmentShader;let bt=a.getVertexShaderStage(_),xe=a.getFragmentShaderStage(_);a.update(_,bt,xe),ht=bt.id,At=xe.id}let Ot=i.getRenderTarget(),vt=i.state.buffers.depth.getReversed(),Bt=U.isInstancedMesh===!0,ye=U.isBatchedMesh===!0,kt=!!_.map,jt=!!_.matcap,Qt=!!z,tt=Qt&&z.isPMREMTexture===!0,ut=!!_.aoMap,at=!!_.lightMap,Tt=!!_.bumpMap&&_.wireframe===!1,yt=!!_.normalMap,Jt=!!_.displacementMap,Ut=!!_.emissiveMap,re=!!_.metalnessMap,oe=!!_.roughnessMap,de=_.anisotropy>0,N=_.clearcoat>0,Oe=_.diffuseRoughness>0,ie=_.dispersion>0,be=_.retroreflectivity>0,gt=_.iridescence>0,Le=_.sheen>0,Gt=_.transmission>0,qt=de&&!!_.anisotropyMap,C=N&&!!_.clearcoatMap,v=N&&!!_.clearcoatNormalMap,B=N&&!!_.clearcoatRoughnessMap,it=Oe&&!!_.diffuseRoughnessMap,K=gt&&!!_.iridescenceMap,lt=gt&&!!_.iridescenceThicknessMap,_t=Le&&!!_.sheenColorMap,Z=Le&&!!_.sheenRoughnessMap,J=!!_.specularMap,dt=!!_.specularColorMap,R=!!_.specularIntensityMap,j=Gt&&!!_.transmissionMap,q=Gt&&!!_.thicknessMap,ft=!!_.gradientMap,ot=!!_.alphaMap,ct=_.alphaTest>0,Ft=!!_.alphaHash,te=!!_.extensions,st=ti;_.toneMapped&&(Ot===null||Ot.isXRRenderTarget===!0)&&(st=i.toneMapping);let zt=tt?z.isCompressedCubeTexture?z.image[0].mipmaps:z.mipmaps:null,Kt={shaderID:nt,shaderType:_.type,shaderName:_.name,vertexShader:Nt,fragmentShader:Y,defines:_.defines,customVertexShaderID:ht,customFragmentShaderID:At,isRawShaderMaterial:_.isRawShaderMaterial===!0,glslVersion:_.glslVersion,precision:H,batching:ye,batchingColor:ye&&U._colorsTexture!==null,instancing:Bt,instancingColor:Bt&&U.instanceColor!==null,instancingMorph:Bt&&U.morphTexture!==null,outputColorSpace:Ot===null?i.outputColorSpace:Ot.isXRRenderTarget===!0?Ot.texture.colorSpace:se.workingColorSpace,alphaToCoverage:!!_.alphaToCoverage,map:kt,matcap:jt,envMap:Qt,envMapMode:Qt&&z.mapping,envMapPMREM:tt,envMapMaxLod:tt?zt.length-1:null,envMapSize:tt?zt[0].width:null,aoMap:ut,lightMap:at,bumpMap:Tt,normalMap:yt,displacementMap:Jt,emissiveMap:Ut,normalMapObjectSpace:yt&&_.normalMapType===tp,normalMapTangentSpace:yt&&_.normalMapType===jh,packedNormalMap:yt&&_.normalMapType===jh&&jb(_.normalMap.format),metalnessMap:re,roughnessMap:oe,anisotropy:de,anisotropyMap:qt,clearcoat:N,clearcoatMap:C,clearcoatNormalMap:v,clearcoatRoughnessMap:B,diffuseRoughness:Oe,diffuseRoughnessMap:it,dispersion:ie,retroreflection:be,iridescence:gt,iridescenceMap:K,iridescenceThicknessMap:lt,sheen:Le,sheenColorMap:_t,sheenRoughnessMap:Z,specularMap:J,specularColorMap:dt,specularIntensityMap:R,transmission:Gt,transmissionMap:j,thicknessMap:q,gradientMap:ft,opaque:_.transparent===!1&&_.blending===Ys&&_.alphaToCoverage===!1,alphaMap:ot,alphaTest:ct,alphaHash:Ft,combine:_.combine,mapUv:kt&&f(_.map.channel),aoMapUv:ut&&f(_.aoMap.channel),lightMapUv:at&&f(_.lightMap.channel),bumpMapUv:Tt&&f(_.bumpMap.channel),normalMapUv:yt&&f(_.normalMap.channel),displacementMapUv:Jt&&f(_.displacementMap.channel),emissiveMapUv:Ut&&f(_.emissiveMap.channel),metalnessMapUv:re&&f(_.metalnessMap.channel),roughnessMapUv:oe&&f(_.roughnessMap.channel),anisotropyMapUv:qt&&f(_.anisotropyMap.channel),clearcoatMapUv:C&&f(_.clearcoatMap.channel),clearcoatNormalMapUv:v&&f(_.clearcoatNormalMap.channel),clearcoatRoughnessMapUv:B&&f(_.clearcoatRoughnessMap.channel),diffuseRoughnessMapUv:it&&f(_.diffuseRoughnessMap.channel),iridescenceMapUv:K&&f(_.iridescenceMap.channel),iridescenceThicknessMapUv:lt&&f(_.iridescenceThicknessMap.channel),sheenColorMapUv:_t&&f(_.sheenColorMap.channel),sheenRoughnessMapUv:Z&&f(_.sheenRoughnessMap.channel),specularMapUv:J&&f(_.specularMap.channel),specularColorMapUv:dt&&f(_.specularColorMap.channel),specularIntensityMapUv:R&&f(_.specularIntensityMap.channel),transmissionMapUv:j&&f(_.transmissionMap.channel),thicknessMapUv:q&&f(_.thicknessMap.channel),alphaMapUv:ot&&f(_.alphaMap.channel),vertexTangents:!!L.attributes.tangent&&(yt||de),vertexNormals:!!L.attributes.normal,vertexColors:_.vertexColors,vertexAlphas:_.vertexColors===!0&&!!L.attributes.color&&L.attributes.color.itemSize===4,pointsUvs:U.isPoints===!0&&!!L.attributes.uv&&(kt||ot),fog:!!$,useFog:_.fog===!0,fogExp2:!!$&&$.isFogExp2,flatShading:_.wireframe===!1&&(_.flatShading===!0||L.attributes.normal===void 0&&yt===!1&&(_.isMeshLambertMaterial||_.isMeshPhongMaterial||_.isMeshStandardMaterial||_.isMeshPhysicalMaterial)),sizeAttenuation:_.sizeAttenuation===!0,logarithmicDepthBuffer:u,reversedDepthBuffer:vt,skinning:U.isSkinnedMesh===!0,hasPositionAttribute:L.attributes.position!==void 0,morphTargets:L.morphAttributes.position!==void 0,morphNormals:L.morphAttributes.normal!==void 0,morphColors:L.morphAttributes.color!==void 0,morphTargetsCount:et,morphTextureStride:Et,numSunLights:E.sun.length,numDirLights:E.directional.length,numPointLights:E.point.length,numSpotLights:E.spot.length,numSpotLightMaps:E.spotLightMap.length,numRectAreaLights:E.rectArea.length,numHemiLights:E.hemi.length,numSunLightShadows:E.sunShadowMap.length,numDirLightShadows:E.directionalShadowMap.length,numPointLightShadows:E.pointShadowMap.length,numSpotLightShadows:E.spotShadowMap.length,numSpotLightShadowsWithMaps:E.numSpotLightShadowsWithMaps,numLightProbes:E.numLightProbes,numLightProbeGrids:G.filter(bt=>bt.texture!==null).length,numClippingPlanes:r.numPlanes,numClipIntersection:r.numIntersection,dithering:_.dithering,shadowMapEnabled:i.shadowMap.enabled&&O.length>0,shadowMapType:i.shadowMap.type,toneMapping:st,decodeVideoTexture:kt&&_.map.isVideoTexture===!0&&se.getTransfer(_.map.colorSpace)===_e,decodeVideoTextureEmissive:Ut&&_.emissiveMap.isVideoTexture===!0&&se.getTransfer(_.emissiveMap.colorSpace)===_e,premultipliedAlpha:_.premultipliedAlpha,doubleSided:_.side===rn,flipSided:_.side===Ge,useDepthPacking:_.depthPacking>=0,depthPacking:_.depthPacking||0,index0AttributeName:_.index0AttributeName,extensionClipCullDistance:te&&_.extensions.clipCullDistance===!0&&e.has("WEBGL_clip_cull_distance"),extensionMultiDraw:(te&&_.extensions.multiDraw===!0||ye)&&e.has("WEBGL_multi_draw"),rendererExtensionParallelShaderCompile:e.has("KHR_parallel_shader_compile"),customProgramCacheKey:_.customProgramCacheKey()};return Kt.vertexUv1s=l.has(1),Kt.vertexUv2s=l.has(2),Kt.vertexUv3s=l.has(3),l.clear(),Kt}function x(_){let E=[];if(_.shaderID?E.push(_.shaderID):(E.push(_.customVertexShaderID),E.push(_.customFragmentShaderID)),_.defines!==void 0)for(let O in _.defines)E.push(O),E.push(_.defines[O]);return _.isRawShaderMaterial===!1&&(p(E,_),g(E,_),E.push(i.outputColorSpace)),E.push(_.customProgramCacheKey),E.join()}function p(_,E){_.push(E.precision),_.push(E.outputColorSpace),_.push(E.envMapMode),_.push(E.envMapPMREM),_.push(E.envMapMaxLod),_.push(E.envMapSize),_.push(E.mapUv),_.push(E.alphaMapUv),_.push(E.lightMapUv),_.push(E.aoMapUv),_.push(E.bumpMapUv),_.push(E.normalMapUv),_.push(E.displacementMapUv),_.push(E.emissiveMapUv),_.push(E.metalnessMapUv),_.push(E.roughnessMapUv),_.push(E.anisotropyMapUv),_.push(E.clearcoatMapUv),_.push(E.clearcoatNormalMapUv),_.push(E.clearcoatRoughnessMapUv),_.push(E.diffuseRoughnessMapUv),_.push(E.iridescenceMapUv),_.push(E.iridescenceThicknessMapUv),_.push(E.sheenColorMapUv),_.push(E.sheenRoughnessMapUv),_.push(E.specularMapUv),_.push(E.specularColorMapUv),_.push(E.specularIntensityMapUv),_.push(E.transmissionMapUv),_.push(E.thicknessMapUv),_.push(E.combine),_.push(E.fogExp2),_.push(E.sizeAttenuation),_.push(E.morphTargetsCount),_.push(E.numSunLights),_.push(E.numDirLights),_.push(E.numPointLights),_.push(E.numSpotLights),_.push(E.numSpotLightMaps),_.push(E.numHemiLights),_.push(E.numRectAreaLights),_.push(E.numSunLightShadows),_.push(E.numDirLightShadows),_.push(E.numPointLightShadows),_.push(E.numSpotLightShadows),_.push(E.numSpotLightShadowsWithMaps),_.push(E.numLightProbes),_.push(E.numLightProbeGrids),_.push(E.shadowMapType),_.push(E.toneMapping),_.push(E.numClippingPlanes),_.push(E.numClipIntersection),_.push(E.depthPacking)}function g(_,E){o.disableAll(),E.instancing&&o.enable(0),E.instancingColor&&o.enable(1),E.instancingMorph&&o.enable(2),E.matcap&&o.enable(3),E.envMap&&o.enable(4),E.normalMapObjectSpace&&o.enable(5),E.normalMapTangentSpace&&o.enable(6),E.clearcoat&&o.enable(7),E.iridescence&&o.enable(8),E.alphaTest&&o.enable(9),E.vertexColors&&o.enable(10),E.vertexAlphas&&o.enable(11),E.vertexUv1s&&o.enable(12),E.vertexUv2s&&o.enable(13),E.vertexUv3s&&o.enable(14),E.vertexTangents&&o.enable(15),E.anisotropy&&o.enable(16),E.alphaHash&&o.enable(17),E.batching&&o.enable(18),E.dispersion&&o.enable(19),E.retroreflection&&o.enable(24),E.diffuseRoughness&&o.enable(25),E.batchingColor&&o.enable(20),E.gradientMap&&o.enable(21),E.packedNormalMap&&o.enable(22),E.vertexNormals&&o.enable(23),_.push(o.mask),o.disableAll(),E.fog&&o.enable(0),E.useFog&&o.enable(1),E.flatShading&&o.enable(2),E.logarithmicDepthBuffer&&o.enable(3),E.reversedDepthBuffer&&o.enable(4),E.skinning&&o.enable(5),E.morphTargets&&o.enable(6),E.morphNormals&&o.enable(7),E.morphColors&&o.enable(8),E.premultipliedAlpha&&o.enable(9),E.shadowMapEnabled&&o.enable(10),E.doubleSided&&o.enable(11),E.flipSided&&o.enable(12),E.useDepthPacking&&o.enable(13),E.dithering&&o.enable(14),E.transmission&&o.enable(15),E.sheen&&o.enable(16),E.opaque&&o.enable(17),E.pointsUvs&&o.enable(18),E.decodeVideoTexture&&o.enable(19),E.decodeVideoTextureEmissive&&o.enable(20),E.alphaToCoverage&&o.enable(21),E.numLightProbeGrids>0&&o.enable(22),E.hasPositionAttribute&&o.enable(23),_.push(o.mask)}function y(_){let E=d[_.type],O;if(E){let P=ni[E];O=xp.clone(P.uniforms)}else O=_.uniforms;return O}function w(_,E){let O=h.get(E);return O!==void 0?++O.usedTimes:(O=new Zb(i,E,_,s),c.push(O),h.set(E,O)),O}function S(_){if(--_.usedTimes===0){let E=c.indexOf(_);c[E]=c[c.length-1],c.pop(),h.delete(_.cacheKey),_.destroy()}}function T(_){a.remove(_)}function A(){a.dispose()}return{getParameters:m,getProgramCacheKey:x,getUniforms:y,acquireProgram:w,releaseProgram:S,releaseShaderCache:T,programs:c,dispose:A}}function Qb(){let i=new WeakMap;function t(o){return i.has(o)}function e(o){let a=i.get(o);return a===void 0&&(a={},i.set(o,a)),a}function n(o){i.delete(o)}function s(o,a,l){i.get(o)[a]=l}function r(){i=new WeakMap}return{has:t,get:e,remove:n,update:s,dispose:r}}function tM(i,t){return i.groupOrder!==t.groupOrder?i.groupOrder-t.groupOrder:i.renderOrder!==t.renderOrder?i.renderOrder-t.renderOrder:i.material.id!==t.material.id?i.material.id-t.material.id:i.materialVariant!==t.materialVariant?i.materialVariant-t.materialVariant:i.z!==t.z?i.z-t.z:i.id-t.id}function Bp(i,t){return i.groupOrder!==t.groupOrder?i.groupOrder-t.groupOrder:i.renderOrder!==t.renderOrder?i.renderOrder-t.renderOrder:i.z!==t.z?t.z-i.z:i.id-t.id}function kp(){let i=[],t=0,e=[],n=[],s=[];function r(){t=0,e.length=0,n.length=0,s.length=0}function o(d){let f=0;return d.isInstancedMesh&&(f+=2),d.isSkinnedMesh&&(f+=1),f}function a(d,f,m,x,p,g){let y=i[t];return y===void 0?(y={id:d.id,object:d,geometry:f,material:m,materialVariant:o(d),groupOrder:x,renderOrder:d.renderOrder,z:p,group:g},i[t]=y):(y.id=d.id,y.object=d,y.geometry=f,y.material=m,y.materialVariant=o(d),y.groupOrder=x,y.renderOrder=d.renderOrder,y.z=p,y.group=g),t++,y}function l(d,f,m,x,p,g,y){y.reversedDepth===!0&&(p=-p);let w=a(d,f,m,x,p,g);m.transmission>0?n.push(w):m.transparent===!0?s.push(w):e.push(w)}function c(d,f,m,x,p,g){let y=a(d,f,m,x,p,g);m.transmission>0?n.unshift(y):m.transparent===!0?s.unshift(y):e.unshift(y)}function h(d,f){e.length>1&&e.sort(d||tM),n.length>1&&n.sort(f||Bp),s.length>1&&s.sort(f||Bp)}function u(){for(let d=t,f=i.length;d<f;d++){let m=i[d];if(m.id===null)break;m.id=null,m.object=null,m.geometry=null,m.material=null,m.group=null}}return{opaque:e,transmissive:n,transparent:s,init:r,push:l,unshift:c,finish:u,sort:h}}function eM(){let i=new WeakMap;function t(n,s){let r=i.get(n),o;return r===void 0?(o=new kp,i.set(n,[o])):s>=r.length?(o=new kp,r.push(o)):o=r[s],o}function e(){i=new WeakMap}return{get:t,dispose:e}}function nM(){let i={};return{get:function(t){if(i[t.id]!==void 0)return i[t.id];let e;switch(t.type){case"SunLight":case"DirectionalLight":e={direction:new I,color:new Yt};break;case"SpotLight":e={position:new I,direction:new I,color:new Yt,distance:0,coneCos:0,penumbraCos:0,decay:0};break;case"PointLight":e={position:new I,color:new Yt,distance:0,decay:0};break;case"HemisphereLight":e={direction:new I,skyColor:new Yt,groundColor:new Yt};break;case"RectAreaLight":e={color:new Yt,position:new I,halfWidth:new I,halfHeight:new I};break}return i[t.id]=e,e}}}function iM(){let i={};return{get:function(t){if(i[t.id]!==void 0)return i[t.id];let e;switch(t.type){case"SunLight":case"DirectionalLight":e={shadowIntensity:1,shadowBias:0,shadowNormalBias:0,shadowRadius:1,shadowMapSize:new rt};break;case"SpotLight":e={shadowIntensity:1,shadowBias:0,shadowNormalBias:0,shadowRadius:1,shadowMapSize:new rt};break;case"PointLight":e={shadowIntensity:1,shadowBias:0,shadowNormalBias:0,shadowRadius:1,shadowMapSize:new rt,shadowCameraNear:1,shadowCameraFar:1e3};break}return i[t.id]=e,e}}}var sM=0;function rM(i,t){return(t.castShadow?2:0)-(i.castShadow?2:0)+(t.map?1:0)-(i.map?1:0)}function oM(i){let t=new nM,e=iM(),n={version:0,hash:{sunLength:-1,directionalLength:-1,pointLength:-1,spotLength:-1,rectAreaLength:-1,hemiLength:-1,numSunShadows:-1,numDirectionalShadows:-1,numPointShadows:-1,numSpotShadows:-1,numSpotMaps:-1,numLightProbes:-1},ambient:[0,0,0],probe:[],sun:[],sunShadow:[],sunShadowMap:[],sunShadowMatrix:[],sunShadowCascade:[],directional:[],directionalShadow:[],directionalShadowMap:[],directionalShadowMatrix:[],spot:[],spotLightMap:[],spotShadow:[],spotShadowMap:[],spotLightMatrix:[],rectArea:[],rectAreaLTC1:null,rectAreaLTC2:null,point:[],pointShadow:[],pointShadowMap:[],pointShadowMatrix:[],hemi:[],numSpotLightShadowsWithMaps:0,numLightProbes:0};for(let c=0;c<9;c++)n.probe.push(new I);let s=new I,r=new ue,o=new ue;function a(c){let h=0,u=0,d=0;for(let G=0;G<9;G++)n.probe[G].set(0,0,0);let f=0,m=0,x=0,p=0,g=0,y=0,w=0,S=0,T=0,A=0,_=0,E=0,O=0,P=0;c.sort(rM);for(let G=0,$=c.length;G<$;G++){let L=c[G],V=L.color,X=L.intensity,z=L.distance,nt=null;if(L.shadow&&L.shadow.map&&(L.shadow.map.texture.format===Wi?nt=L.shadow.map.texture:nt=L.shadow.map.depthTexture||L.shadow.map.texture),L.isAmbientLight)h+=V.r*X,u+=V.g*X,d+=V.b*X;else if(L.isLightProbe){for(let H=0;H<9;H++)n.probe[H].addScaledVector(L.sh.coefficients[H],X);P++}else if(L.isSunLight){let H=t.get(L);if(H.color.copy(L.color).multiplyScalar(L.intensity),L.castShadow){let Q=L.shadow,et=e.get(L);et.shadowIntensity=Q.intensity,et.shadowBias=Q.bias,et.shadowNormalBias=Q.normalBias,et.shadowRadius=Q.radius,et.shadowMapSize.copy(Q.mapSize).multiply(Q.getFrameExtents()),n.sunShadow[m]=et,n.sunShadowMap[m]=nt;let Et=Q.getViewportCount();for(let Nt=0;Nt<Et;Nt++)n.sunShadowMatrix[x+Nt]=Q.getMatrix(Nt),n.sunShadowCascade[x+Nt]=Q._cascadeData[Nt];x+=Et,m++}n.sun[f]=H,f++}else if(L.isDirectionalLight){let H=t.get(L);if(H.color.copy(L.color).multiplyScalar(L.intensity),L.castShadow){let Q=L.shadow,et=e.get(L);et.shadowIntensity=Q.intensity,et.shadowBias=Q.bias,et.shadowNormalBias=Q.normalBias,et.shadowRadius=Q.radius,et.shadowMapSize=Q.mapSize,n.directionalShadow[p]=et,n.directionalShadowMap[p]=nt,n.directionalShadowMatrix[p]=L.shadow.matrix,T++}n.directional[p]=H,p++}else if(L.isSpotLight){let H=t.get(L);H.position.setFromMatrixPosition(L.matrixWorld),H.color.copy(V).multiplyScalar(X),H.distance=z,H.coneCos=Math.cos(L.angle),H.penumbraCos=Math.cos(L.angle*(1-L.penumbra)),H.decay=L.decay,n.spot[y]=H;let Q=L.shadow;if(L.map&&(n.spotLightMap[E]=L.map,E++,Q.updateMatrices(L),L.castShadow&&O++),n.spotLightMatrix[y]=Q.matrix,L.castShadow){let et=e.get(L);et.shadowIntensity=Q.intensity,et.shadowBias=Q.bias,et.shadowNormalBias=Q.normalBias,et.shadowRadius=Q.radius,et.shadowMapSize=Q.mapSize,n.spotShadow[y]=et,n.spotShadowMap[y]=nt,_++}y++}else if(L.isRectAreaLight){let H=t.get(L);H.color.copy(V).multiplyScalar(X),H.halfWidth.set(L.width*.5,0,0),H.halfHeight.set(0,L.height*.5,0),n.rectArea[w]=H,w++}else if(L.isPointLight){let H=t.get(L);if(H.color.copy(L.color).multiplyScalar(L.intensity),H.distance=L.distance,H.decay=L.decay,L.castShadow){let Q=L.shadow,et=e.get(L);et.shadowIntensity=Q.intensity,et.shadowBias=Q.bias,et.shadowNormalBias=Q.normalBias,et.shadowRadius=Q.radius,et.shadowMapSize=Q.mapSize,et.shadowCameraNear=Q.camera.near,et.shadowCameraFar=Q.camera.far,n.pointShadow[g]=et,n.pointShadowMap[g]=nt,n.pointShadowMatrix[g]=L.shadow.matrix,A++}n.point[g]=H,g++}else if(L.isHemisphereLight){let H=t.get(L);H.skyColor.copy(L.color).multiplyScalar(X),H.groundColor.copy(L.groundColor).multiplyScalar(X),n.hemi[S]=H,S++}}w>0&&(i.has("OES_texture_float_linear")===!0?(n.rectAreaLTC1=Mt.LTC_FLOAT_1,n.rectAreaLTC2=Mt.LTC_FLOAT_2):(n.rectAreaLTC1=Mt.LTC_HALF_1,n.rectAreaLTC2=Mt.LTC_HALF_2)),n.ambient[0]=h,n.ambient[1]=u,n.ambient[2]=d;let U=n.hash;(U.sunLength!==f||U.directionalLength!==p||U.pointLength!==g||U.spotLength!==y||U.rectAreaLength!==w||U.hemiLength!==S||U.numSunShadows!==m||U.numDirectionalShadows!==T||U.numPointShadows!==A||U.numSpotShadows!==_||U.numSpotMaps!==E||U.numLightProbes!==P)&&(n.sun.length=f,n.directional.length=p,n.spot.length=y,n.rectArea.length=w,n.point.length=g,n.hemi.length=S,n.sunShadow.length=m,n.sunShadowMap.length=m,n.sunShadowMatrix.length=x,n.sunShadowCascade.length=x,n.directionalShadow.length=T,n.directionalShadowMap.length=T,n.directionalShadowMatrix.length=T,n.pointShadow.length=A,n.pointShadowMap.length=A,n.pointShadowMatrix.length=A,n.spotShadow.length=_,n.spotShadowMap.length=_,n.spotLightMatrix.length=_+E-O,n.spotLightMap.length=E,n.numSpotLightShadowsWithMaps=O,n.numLightProbes=P,U.sunLength=f,U.directionalLength=p,U.pointLength=g,U.spotLength=y,U.rectAreaLength=w,U.hemiLength=S,U.numSunShadows=m,U.numDirectionalShadows=T,U.numPointShadows=A,U.numSpotShadows=_,U.numSpotMaps=E,U.numLightProbes=P,n.version=sM++)}function l(c,h){let u=0,d=0,f=0,m=0,x=0,p=0,g=h.matrixWorldInverse;for(let y=0,w=c.length;y<w;y++){let S=c[y];if(S.isSunLight){let T=n.sun[u];T.direction.setFromMatrixPosition(S.matrixWorld),T.direction.transformDirection(g),u++}else if(S.isDirectionalLight){let T=n.directional[d];T.direction.setFromMatrixPosition(S.matrixWorld),s.setFromMatrixPosition(S.target.matrixWorld),T.direction.sub(s),T.direction.transformDirection(g),d++}else if(S.isSpotLight){let T=n.spot[m];T.position.setFromMatrixPosition(S.matrixWorld),T.position.applyMatrix4(g),T.direction.setFromMatrixPosition(S.matrixWorld),s.setFromMatrixPosition(S.target.matrixWorld),T.direction.sub(s),T.direction.transformDirection(g),m++}else if(S.isRectAreaLight){let T=n.rectArea[x];T.position.setFromMatrixPosition(S.matrixWorld),T.position.applyMatrix4(g),o.identity(),r.copy(S.matrixWorld),r.premultiply(g),o.extractRotation(r),T.halfWidth.set(S.width*.5,0,0),T.halfHeight.set(0,S.height*.5,0),T.halfWidth.applyMatrix4(o),T.halfHeight.applyMatrix4(o),x++}else if(S.isPointLight){let T=n.point[f];T.position.setFromMatrixPosition(S.matrixWorld),T.position.applyMatrix4(g),f++}else if(S.isHemisphereLight){let T=n.hemi[p];T.direction.setFromMatrixPosition(S.matrixWorld),T.direction.transformDirection(g),p++}}}return{setup:a,setupView:l,state:n}}function zp(i){let t=new oM(i),e=[],n=[],s=[];function r(u){h.camera=u,e.length=0,n.length=0,s.length=0}function o(u){u.isLightProbeGrid?s.push(u):e.push(u)}function a(u){n.push(u)}function l(){t.setup(e),s.sort((u,d)=>u.priority-d.priority||u.id-d.id)}function c(u){t.setupView(e,u)}let h={lightsArray:e,shadowsArray:n,lightProbeGridArray:s,camera:null,lights:t,transmissionRenderTarget:{},textureUnits:0};return{init:r,state:h,setupLights:l,setupLightsView:c,pushLight:o,pushShadow:a}}function aM(i){let t=new WeakMap;function e(s,r=0){let o=t.get(s),a;return o===void 0?(a=new zp(i),t.set(s,[a])):r>=o.length?(a=new zp(i),o.push(a)):a=o[r],a}function n(){t=new WeakMap}return{get:e,dispose:n}}var lM=`void main() {
	gl_Position = vec4( position, 1.0 );
}`,cM=`uniform sampler2D shadow_pass;
uniform vec2 resolution;
uniform float radius;
void main() {
	const float samples = float( VSM_SAMPLES );
	float mean = 0.0;
	float squared_mean = 0.0;
	float uvStride = samples <= 1.0 ? 0.0 : 2.0 / ( samples - 1.0 );
	float uvStart = samples <= 1.0 ? 0.0 : - 1.0;
	for ( float i = 0.0; i < samples; i ++ ) {
		float uvOffset = uvStart + i * uvStride;
		#ifdef HORIZONTAL_PASS
			vec2 distribution = texture2D( shadow_pass, ( gl_FragCoord.xy + vec2( uvOffset, 0.0 ) * radius ) / resolution ).rg;
			mean += distribution.x;
			squared_mean += distribution.y * distribution.y + distribution.x * distribution.x;
		#else
			float depth = texture2D( shadow_pass, ( gl_FragCoord.xy + vec2( 0.0, uvOffset ) * radius ) / resolution ).r;
			mean += depth;
			squared_mean += depth * depth;
		#endif
	}
	mean = mean / samples;
	squared_mean = squared_mean / samples;
	float std_dev = sqrt( max( 0.0, squared_mean - mean * mean ) );
	gl_FragColor = vec4( mean, std_dev, 0.0, 1.0 );
}`,hM=[new I(1,0,0),new I(-1,0,0),new I(0,1,0),new I(0,-1,0),new I(0,0,1),new I(0,0,-1)],uM=[new I(0,-1,0),new I(0,-1,0),new I(0,0,1),new I(0,0,-1),new I(0,-1,0),new I(0,-1,0)],Gp=new ue,co=new I,mu=new I;function dM(i,t,e){let n=new rs,s=new rt,r=new rt,o=new Te,a=new Wa,l=new Xa,c={},h=e.maxTextureSize,u={[bn]:Ge,[Ge]:bn,[rn]:rn},d=new Je({defines:{VSM_SAMPLES:8},uniforms:{shadow_pass:{value:null},resolution:{value:new rt},radius:{value:4}},vertexShader:lM,fragmentShader:cM}),f=d.clone();f.defines.HORIZONTAL_PASS=1;let m=new Se;m.setAttribute("position",new Ce(new Float32Array([-1,-1,.5,3,-1,.5,-1,3,.5]),3));let x=new Ee(m,d),p=this;this.enabled=!1,this.autoUpdate=!0,this.needsUpdate=!1,this.type=to;let g=this.type;this.render=function(A,_,E){if(p.enabled===!1||p.autoUpdate===!1&&p.needsUpdate===!1||A.length===0)return;this.type===Nf&&(Vt("WebGLShadowMap: PCFSoftShadowMap has been removed. Using PCFShadowMap instead."),this.type=to);let O=i.getRenderTarget(),P=i.getActiveCubeFace(),U=i.getActiveMipmapLevel(),G=i.state;G.setBlending(as),G.buffers.depth.getReversed()===!0?G.buffers.color.setClear(0,0,0,0):G.buffers.color.setClear(1,1,1,1),G.buffers.depth.setTest(!0),G.setScissorTest(!1);let $=g!==this.type;$&&_.traverse(function(L){L.material&&(Array.isArray(L.material)?L.material.forEach(V=>V.needsUpdate=!0):L.material.needsUpdate=!0)});for(let L=0,V=A.length;L<V;L++){let X=A[L],z=X.shadow;if(z===void 0){Vt("WebGLShadowMap:",X,"has no shadow.");continue}if(z.autoUpdate===!1&&z.needsUpdate===!1)continue;s.copy(z.mapSize);let nt=z.getFrameExtents();s.multiply(nt),r.copy(z.mapSize),(s.x>h||s.y>h)&&(s.x>h&&(r.x=Math.floor(h/nt.x),s.x=r.x*nt.x,z.mapSize.x=r.x),s.y>h&&(r.y=Math.floor(h/nt.y),s.y=r.y*nt.y,z.mapSize.y=r.y));let H=i.state.buffers.depth.getReversed();if(z.camera._reversedDepth=H,z.map===null||$===!0){if(z.map!==null&&(z.map.depthTexture!==null&&(z.map.depthTexture.dispose(),z.map.depthTexture=null),z.map.dispose()),this.type===$s){if(X.isPointLight){Vt("WebGLShadowMap: VSM shadow maps are not supported for PointLights. Use PCF or BasicShadowMap instead.");continue}z.map=new Ze(s.x,s.y,{format:Wi,type:zn,minFilter:Ye,magFilter:Ye,generateMipmaps:!1}),z.map.texture.name=X.name+".shadowMap",z.map.depthTexture=new yi(s.x,s.y,fn),z.map.depthTexture.name=X.name+".shadowMapDepth",z.map.depthTexture.format=gi,z.map.depthTexture.compareFunction=null,z.map.depthTexture.minFilter=Ne,z.map.depthTexture.magFilter=Ne}else X.isPointLight?(z.map=new uo(s.x),z.map.depthTexture=new Fr(s.x,kn)):(z.map=new Ze(s.x,s.y),z.map.depthTexture=new yi(s.x,s.y,kn)),z.map.depthTexture.name=X.name+".shadowMap",z.map.depthTexture.format=gi,this.type===to?(z.map.depthTexture.compareFunction=H?nu:eu,z.map.depthTexture.minFilter=Ye,z.map.depthTexture.magFilter=Ye):(z.map.depthTexture.compareFunction=null,z.map.depthTexture.minFilter=Ne,z.map.depthTexture.magFilter=Ne);z.camera.updateProjectionMatrix()}z.map.isWebGLCubeRenderTarget!==!0&&(z.map.width!==s.x||z.map.height!==s.y)&&z.map.setSize(s.x,s.y);let Q=z.map.isWebGLCubeRenderTarget?6:z.getViewportCount();X.isPointLight!==!0&&z.updateMatrices(X,E);let et=(z.camera.layers.mask&4294967294)!==0?z.camera.layers:E.layers;for(let Et=0;Et<Q;Et++){let Nt=z.getCamera(Et);if(X.isPointLight){let Y=z.camera,ht=z.matrix,At=X.distance||Y.far;At!==Y.far&&(Y.far=At,Y.updateProjectionMatrix()),co.setFromMatrixPosition(X.matrixWorld),Y.position.copy(co),mu.copy(Y.position),mu.add(hM[Et]),Y.up.copy(uM[Et]),Y.lookAt(mu),Y.updateMatrixWorld(),ht.makeTranslation(-co.x,-co.y,-co.z),Gp.multiplyMatrices(Y.projectionMatrix,Y.matrixWorldInverse),z._frustum.setFromProjectionMatrix(Gp,Y.coordinateSystem,Y.reversedDepth)}if(z.map.isWebGLCubeRenderTarget)i.setRenderTarget(z.map,Et),i.clear();else{Et===0&&(i.setRenderTarget(z.map),i.clear());let Y=z.getViewport(Et);o.set(r.x*Y.x,r.y*Y.y,r.x*Y.z,r.y*Y.w),G.viewport(o)}n=z.getFrustum(Et),S(_,E,Nt,X,et,this.type)}z.isPointLightShadow!==!0&&this.type===$s&&y(z,E),z.needsUpdate=!1}g=this.type,p.needsUpdate=!1,i.setRenderTarget(O,P,U)};function y(A,_){let E=t.update(x);d.defines.VSM_SAMPLES!==A.blurSamples&&(d.defines.VSM_SAMPLES=A.blurSamples,f.defines.VSM_SAMPLES=A.blurSamples,d.needsUpdate=!0,f.needsUpdate=!0),A.mapPass===null?A.mapPass=new Ze(s.x,s.y,{format:Wi,type:zn}):(A.mapPass.width!==A.map.width||A.mapPass.height!==A.map.height)&&A.mapPass.setSize(A.map.width,A.map.height),d.uniforms.shadow_pass.value=A.map.depthTexture,d.uniforms.resolution.value.set(A.map.width,A.map.height),d.uniforms.radius.value=A.radius,i.setRenderTarget(A.mapPass),i.clear(),i.renderBufferDirect(_,null,E,d,x,null),f.uniforms.shadow_pass.value=A.mapPass.texture,f.uniforms.resolution.value.set(A.map.width,A.map.height),f.uniforms.radius.value=A.radius,i.setRenderTarget(A.map),i.clear(),i.renderBufferDirect(_,null,E,f,x,null)}function w(A,_,E,O){let P=null,U=E.isPointLight===!0?A.customDistanceMaterial:A.customDepthMaterial;if(U!==void 0)P=U;else if(P=E.isPointLight===!0?l:a,i.localClippingEnabled&&_.clipShadows===!0&&Array.isArray(_.clippingPlanes)&&_.clippingPlanes.length!==0||_.displacementMap&&_.displacementScale!==0||_.alphaMap&&_.alphaTest>0||_.map&&_.alphaTest>0||_.alphaToCoverage===!0){let G=P.uuid,$=_.uuid,L=c[G];L===void 0&&(L={},c[G]=L);let V=L[$];V===void 0&&(V=P.clone(),L[$]=V,_.addEventListener("dispose",T)),P=V}if(P.visible=_.visible,P.wireframe=_.wireframe,O===$s?P.side=_.shadowSide!==null?_.shadowSide:_.side:P.side=_.shadowSide!==null?_.shadowSide:u[_.side],P.alphaMap=_.alphaMap,P.alphaTest=_.alphaToCoverage===!0?.5:_.alphaTest,P.map=_.map,P.clipShadows=_.clipShadows,P.clippingPlanes=_.clippingPlanes,P.clipIntersection=_.clipIntersection,P.displacementMap=_.displacementMap,P.displacementScale=_.displacementScale,P.displacementBias=_.displacementBias,P.wireframeLinewidth=_.wireframeLinewidth,P.linewidth=_.linewidth,E.isPointLight===!0&&P.isMeshDistanceMaterial===!0){let G=i.properties.get(P);G.light=E}return P}function S(A,_,E,O,P,U){if(A.visible===!1)return;if(A.layers.test(P)&&(A.isMesh||A.isLine||A.isPoints)&&(A.castShadow||A.receiveShadow&&U===$s)&&(!A.frustumCulled||A.intersectsFrustum(n))){A.modelViewMatrix.multiplyMatrices(E.matrixWorldInverse,A.matrixWorld);let L=t.update(A),V=A.material;if(Array.isArray(V)){let X=L.groups;for(let z=0,nt=X.length;z<nt;z++){let H=X[z],Q=V[H.materialIndex];if(Q&&Q.visible){let et=w(A,Q,O,U);A.onBeforeShadow(i,A,_,E,L,et,H),i.renderBufferDirect(E,null,L,et,A,H),A.onAfterShadow(i,A,_,E,L,et,H)}}}else if(V.visible){let X=w(A,V,O,U);A.onBeforeShadow(i,A,_,E,L,X,null),i.renderBufferDirect(E,null,L,X,A,null),A.onAfterShadow(i,A,_,E,L,X,null)}}let $=A.children;for(let L=0,V=$.length;L<V;L++)S($[L],_,E,O,P,U)}function T(A){A.target.removeEventListener("dispose",T);for(let E in c){let O=c[E],P=A.target.uuid;P in O&&(O[P].dispose(),delete O[P])}}}function fM(i,t){function e(){let R=!1,j=new Te,q=null,ft=new Te(0,0,0,0);return{setMask:function(ot){q!==ot&&!R&&(i.colorMask(ot,ot,ot,ot),q=ot)},setLocked:function(ot){R=ot},setClear:function(ot,ct,Ft,te,st){st===!0&&(ot*=te,ct*=te,Ft*=te),j.set(ot,ct,Ft,te),ft.equals(j)===!1&&(i.clearColor(ot,ct,Ft,te),ft.copy(j))},reset:function(){R=!1,q=null,ft.set(-1,0,0,0)}}}function n(){let R=!1,j=!1,q=null,ft=null,ot=null;return{setReversed:function(ct){if(j!==ct){let Ft=t.get("EXT_clip_control");ct?Ft.clipControlEXT(Ft.LOWER_LEFT_EXT,Ft.ZERO_TO_ONE_EXT):Ft.clipControlEXT(Ft.LOWER_LEFT_EXT,Ft.NEGATIVE_ONE_TO_ONE_EXT),j=ct;let te=ot;ot=null,this.setClear(te)}},getReversed:function(){return j},setTest:function(ct){ct?vt(i.DEPTH_TEST):Bt(i.DEPTH_TEST)},setMask:function(ct){q!==ct&&!R&&(i.depthMask(ct),q=ct)},setFunc:function(ct){if(j&&(ct=hp[ct]),ft!==ct){switch(ct){case va:i.depthFunc(i.NEVER);break;case ya:i.depthFunc(i.ALWAYS);break;case ba:i.depthFunc(i.LESS);break;case Us:i.depthFunc(i.LEQUAL);break;case Ma:i.depthFunc(i.EQUAL);break;case Sa:i.depthFunc(i.GEQUAL);break;case wa:i.depthFunc(i.GREATER);break;case Ea:i.depthFunc(i.NOTEQUAL);break;default:i.depthFunc(i.LEQUAL)}ft=ct}},setLocked:function(ct){R=ct},setClear:function(ct){ot!==ct&&(ot=ct,j&&(ct=1-ct),i.clearDepth(ct))},reset:function(){R=!1,q=null,ft=null,ot=null,j=!1}}}function s(){let R=!1,j=null,q=null,ft=null,ot=null,ct=null,Ft=null,te=null,st=null;return{setTest:function(zt){R||(zt?vt(i.STENCIL_TEST):Bt(i.STENCIL_TEST))},setMask:function(zt){j!==zt&&!R&&(i.stencilMask(zt),j=zt)},setFunc:function(zt,Kt,bt){(q!==zt||ft!==Kt||ot!==bt)&&(i.stencilFunc(zt,Kt,bt),q=zt,ft=Kt,ot=bt)},setOp:function(zt,Kt,bt){(ct!==zt||Ft!==Kt||te!==bt)&&(i.stencilOp(zt,Kt,bt),ct=zt,Ft=Kt,te=bt)},setLocked:function(zt){R=zt},setClear:function(zt){st!==zt&&(i.clearStencil(zt),st=zt)},reset:function(){R=!1,j=null,q=null,ft=null,ot=null,ct=null,Ft=null,te=null,st=null}}}let r=new e,o=new n,a=new s,l={},c=new WeakMap,h={},u={},d={},f=new WeakMap,m=[],x=null,p=!1,g=null,y=null,w=null,S=null,T=null,A=null,_=null,E=new Yt(0,0,0),O=0,P=!1,U=null,G=null,$=null,L=null,V=null,X=i.getParameter(i.MAX_COMBINED_TEXTURE_IMAGE_UNITS),z=!1,nt=0,H=i.getParameter(i.VERSION);H.indexOf("WebGL")!==-1?(nt=parseFloat(/^WebGL (\d)/.exec(H)[1]),z=nt>=1):H.indexOf("OpenGL ES")!==-1&&(nt=parseFloat(/^OpenGL ES (\d)/.exec(H)[1]),z=nt>=2);let Q=null,et={},Et=i.getParameter(i.SCISSOR_BOX),Nt=i.getParameter(i.VIEWPORT),Y=new Te().fromArray(Et),ht=new Te().fromArray(Nt);function At(R,j,q,ft){let ot=new Uint8Array(4),ct=i.createTexture();i.bindTexture(R,ct),i.texParameteri(R,i.TEXTURE_MIN_FILTER,i.NEAREST),i.texParameteri(R,i.TEXTURE_MAG_FILTER,i.NEAREST);for(let Ft=0;Ft<q;Ft++)R===i.TEXTURE_3D||R===i.TEXTURE_2D_ARRAY?i.texImage3D(j,0,i.RGBA,1,1,ft,0,i.RGBA,i.UNSIGNED_BYTE,ot):i.texImage2D(j+Ft,0,i.RGBA,1,1,0,i.RGBA,i.UNSIGNED_BYTE,ot);return ct}let Ot={};Ot[i.TEXTURE_2D]=At(i.TEXTURE_2D,i.TEXTURE_2D,1),Ot[i.TEXTURE_CUBE_MAP]=At(i.TEXTURE_CUBE_MAP,i.TEXTURE_CUBE_MAP_POSITIVE_X,6),Ot[i.TEXTURE_2D_ARRAY]=At(i.TEXTURE_2D_ARRAY,i.TEXTURE_2D_ARRAY,1,1),Ot[i.TEXTURE_3D]=At(i.TEXTURE_3D,i.TEXTURE_3D,1,1),r.setClear(0,0,0,1),o.setClear(1),a.setClear(0),vt(i.DEPTH_TEST),o.setFunc(Us),Tt(!1),yt(Ph),vt(i.CULL_FACE),ut(as);function vt(R){h[R]!==!0&&(i.enable(R),h[R]=!0)}function Bt(R){h[R]!==!1&&(i.disable(R),h[R]=!1)}function ye(R,j){return d[R]!==j?(i.bindFramebuffer(R,j),d[R]=j,R===i.DRAW_FRAMEBUFFER&&(d[i.FRAMEBUFFER]=j),R===i.FRAMEBUFFER&&(d[i.DRAW_FRAMEBUFFER]=j),!0):!1}function kt(R,j){let q=m,ft=!1;if(R){q=f.get(j),q===void 0&&(q=[],f.set(j,q));let ot=R.textures;if(q.length!==ot.length||q[0]!==i.COLOR_ATTACHMENT0){for(let ct=0,Ft=ot.length;ct<Ft;ct++)q[ct]=i.COLOR_ATTACHMENT0+ct;q.length=ot.length,ft=!0}}else q[0]!==i.BACK&&(q[0]=i.BACK,ft=!0);ft&&i.drawBuffers(q)}function jt(R){return x!==R?(i.useProgram(R),x=R,!0):!1}let Qt={[ls]:i.FUNC_ADD,[Uf]:i.FUNC_SUBTRACT,[Of]:i.FUNC_REVERSE_SUBTRACT};Qt[Ff]=i.MIN,Qt[sl]=i.MAX;let tt={[Bf]:i.ZERO,[eo]:i.ONE,[kf]:i.SRC_COLOR,[Nh]:i.SRC_ALPHA,[Xf]:i.SRC_ALPHA_SATURATE,[Hf]:i.DST_COLOR,[Gf]:i.DST_ALPHA,[zf]:i.ONE_MINUS_SRC_COLOR,[Uh]:i.ONE_MINUS_SRC_ALPHA,[Wf]:i.ONE_MINUS_DST_COLOR,[Vf]:i.ONE_MINUS_DST_ALPHA,[qf]:i.CONSTANT_COLOR,[$f]:i.ONE_MINUS_CONSTANT_COLOR,[Yf]:i.CONSTANT_ALPHA,[Zf]:i.ONE_MINUS_CONSTANT_ALPHA};function ut(R,j,q,ft,ot,ct,Ft,te,st,zt){if(R===as){p===!0&&(Bt(i.BLEND),p=!1);return}if(p===!1&&(vt(i.BLEND),p=!0),R!==il){if(R!==g||zt!==P){if((y!==ls||T!==ls)&&(i.blendEquation(i.FUNC_ADD),y=ls,T=ls),zt)switch(R){case Ys:i.blendFuncSeparate(i.ONE,i.ONE_MINUS_SRC_ALPHA,i.ONE,i.ONE_MINUS_SRC_ALPHA);break;case Ih:i.blendFunc(i.ONE,i.ONE);break;case Lh:i.blendFuncSeparate(i.ZERO,i.ONE_MINUS_SRC_COLOR,i.ZERO,i.ONE);break;case Dh:i.blendFuncSeparate(i.DST_COLOR,i.ONE_MINUS_SRC_ALPHA,i.ZERO,i.ONE);break;default:Wt("WebGLState: Invalid blending: ",R);break}else switch(R){case Ys:i.blendFuncSeparate(i.SRC_ALPHA,i.ONE_MINUS_SRC_ALPHA,i.ONE,i.ONE_MINUS_SRC_ALPHA);break;case Ih:i.blendFuncSeparate(i.SRC_ALPHA,i.ONE,i.ONE,i.ONE);break;case Lh:Wt("WebGLState: SubtractiveBlending requires material.premultipliedAlpha = true");break;case Dh:Wt("WebGLState: MultiplyBlending requires material.premultipliedAlpha = true");break;default:Wt("WebGLState: Invalid blending: ",R);break}w=null,S=null,A=null,_=null,E.set(0,0,0),O=0,g=R,P=zt}return}ot=ot||j,ct=ct||q,Ft=Ft||ft,(j!==y||ot!==T)&&(i.blendEquationSeparate(Qt[j],Qt[ot]),y=j,T=ot),(q!==w||ft!==S||ct!==A||Ft!==_)&&(i.blendFuncSeparate(tt[q],tt[ft],tt[ct],tt[Ft]),w=q,S=ft,A=ct,_=Ft),(te.equals(E)===!1||st!==O)&&(i.blendColor(te.r,te.g,te.b,st),E.copy(te),O=st),g=R,P=!1}function at(R,j){R.side===rn?Bt(i.CULL_FACE):vt(i.CULL_FACE);let q=R.side===Ge;j&&(q=!q),Tt(q),R.blending===Ys&&R.transparent===!1?ut(as):ut(R.blending,R.blendEquation,R.blendSrc,R.blendDst,R.blendEquationAlpha,R.blendSrcAlpha,R.blendDstAlpha,R.blendColor,R.blendAlpha,R.premultipliedAlpha),o.setFunc(R.depthFunc),o.setTest(R.depthTest),o.setMask(R.depthWrite),r.setMask(R.colorWrite);let ft=R.stencilWrite;a.setTest(ft),ft&&(a.setMask(R.stencilWriteMask),a.setFunc(R.stencilFunc,R.stencilRef,R.stencilFuncMask),a.setOp(R.stencilFail,R.stencilZFail,R.stencilZPass)),Ut(R.polygonOffset,R.polygonOffsetFactor,R.polygonOffsetUnits),R.alphaToCoverage===!0?vt(i.SAMPLE_ALPHA_TO_COVERAGE):Bt(i.SAMPLE_ALPHA_TO_COVERAGE)}function Tt(R){U!==R&&(R?i.frontFace(i.CW):i.frontFace(i.CCW),U=R)}function yt(R){R!==Lf?(vt(i.CULL_FACE),R!==G&&(R===Ph?i.cullFace(i.BACK):R===Df?i.cullFace(i.FRONT):i.cullFace(i.FRONT_AND_BACK))):Bt(i.CULL_FACE),G=R}function Jt(R){R!==$&&(z&&i.lineWidth(R),$=R)}function Ut(R,j,q){R?(vt(i.POLYGON_OFFSET_FILL),(L!==j||V!==q)&&(L=j,V=q,o.getReversed()&&(j=-j,q=-q),i.polygonOffset(j,q))):Bt(i.POLYGON_OFFSET_FILL)}function re(R){R?vt(i.SCISSOR_TEST):Bt(i.SCISSOR_TEST)}function oe(R){R===void 0&&(R=i.TEXTURE0+X-1),Q!==R&&(i.activeTexture(R),Q=R)}function de(R,j,q){q===void 0&&(Q===null?q=i.TEXTURE0+X-1:q=Q);let ft=et[q];ft===void 0&&(ft={type:void 0,texture:void 0},et[q]=ft),(ft.type!==R||ft.texture!==j)&&(Q!==q&&(i.activeTexture(q),Q=q),i.bindTexture(R,j||Ot[R]),ft.type=R,ft.texture=j)}function N(){let R=et[Q];R!==void 0&&R.type!==void 0&&(i.bindTexture(R.type,null),R.type=void 0,R.texture=void 0)}function Oe(){try{i.compressedTexImage2D(...arguments)}catch(R){Wt("WebGLState:",R)}}function ie(){try{i.compressedTexImage3D(...arguments)}catch(R){Wt("WebGLState:",R)}}function be(){try{i.texSubImage2D(...arguments)}catch(R){Wt("WebGLState:",R)}}function gt(){try{i.texSubImage3D(...arguments)}catch(R){Wt("WebGLState:",R)}}function Le(){try{i.compressedTexSubImage2D(...arguments)}catch(R){Wt("WebGLState:",R)}}function Gt(){try{i.compressedTexSubImage3D(...arguments)}catch(R){Wt("WebGLState:",R)}}function qt(){try{i.texStorage2D(...arguments)}catch(R){Wt("WebGLState:",R)}}function C(){try{i.texStorage3D(...arguments)}catch(R){Wt("WebGLState:",R)}}function v(){try{i.texImage2D(...arguments)}catch(R){Wt("WebGLState:",R)}}function B(){try{i.texImage3D(...arguments)}catch(R){Wt("WebGLState:",R)}}function it(R){return u[R]!==void 0?u[R]:i.getParameter(R)}function K(R,j){u[R]!==j&&(i.pixelStorei(R,j),u[R]=j)}function lt(R){Y.equals(R)===!1&&(i.scissor(R.x,R.y,R.z,R.w),Y.copy(R))}function _t(R){ht.equals(R)===!1&&(i.viewport(R.x,R.y,R.z,R.w),ht.copy(R))}function Z(R,j){let q=c.get(j);q===void 0&&(q=new WeakMap,c.set(j,q));let ft=q.get(R);ft===void 0&&(ft=i.getUniformBlockIndex(j,R.name),i.uniformBlockBinding(j,ft,ft),q.set(R,ft))}function J(R,j,q){let ot=c.get(j).get(R);l[ot]!==q&&(i.bindBufferBase(i.UNIFORM_BUFFER,ot,q),l[ot]=q)}function dt(){i.disable(i.BLEND),i.disable(i.CULL_FACE),i.disable(i.DEPTH_TEST),i.disable(i.POLYGON_OFFSET_FILL),i.disable(i.SCISSOR_TEST),i.disable(i.STENCIL_TEST),i.disable(i.SAMPLE_ALPHA_TO_COVERAGE),i.blendEquation(i.FUNC_ADD),i.blendFunc(i.ONE,i.ZERO),i.blendFuncSeparate(i.ONE,i.ZERO,i.ONE,i.ZERO),i.blendColor(0,0,0,0),i.colorMask(!0,!0,!0,!0),i.clearColor(0,0,0,0),i.depthMask(!0),i.depthFunc(i.LESS),o.setReversed(!1),i.clearDepth(1),i.stencilMask(4294967295),i.stencilFunc(i.ALWAYS,0,4294967295),i.stencilOp(i.KEEP,i.KEEP,i.KEEP),i.clearStencil(0),i.cullFace(i.BACK),i.frontFace(i.CCW),i.polygonOffset(0,0),i.activeTexture(i.TEXTURE0),i.bindFramebuffer(i.FRAMEBUFFER,null),i.bindFramebuffer(i.DRAW_FRAMEBUFFER,null),i.bindFramebuffer(i.READ_FRAMEBUFFER,null),i.useProgram(null),i.lineWidth(1),i.scissor(0,0,i.canvas.width,i.canvas.height),i.viewport(0,0,i.canvas.width,i.canvas.height),i.pixelStorei(i.PACK_ALIGNMENT,4),i.pixelStorei(i.UNPACK_ALIGNMENT,4),i.pixelStorei(i.UNPACK_FLIP_Y_WEBGL,!1),i.pixelStorei(i.UNPACK_PREMULTIPLY_ALPHA_WEBGL,!1),i.pixelStorei(i.UNPACK_COLORSPACE_CONVERSION_WEBGL,i.BROWSER_DEFAULT_WEBGL),i.pixelStorei(i.PACK_ROW_LENGTH,0),i.pixelStorei(i.PACK_SKIP_PIXELS,0),i.pixelStorei(i.PACK_SKIP_ROWS,0),i.pixelStorei(i.UNPACK_ROW_LENGTH,0),i.pixelStorei(i.UNPACK_IMAGE_HEIGHT,0),i.pixelStorei(i.UNPACK_SKIP_PIXELS,0),i.pixelStorei(i.UNPACK_SKIP_ROWS,0),i.pixelStorei(i.UNPACK_SKIP_IMAGES,0),h={},u={},Q=null,et={},d={},l={},f=new WeakMap,m=[],x=null,p=!1,g=null,y=null,w=null,S=null,T=null,A=null,_=null,E=new Yt(0,0,0),O=0,P=!1,U=null,G=null,$=null,L=null,V=null,Y.set(0,0,i.canvas.width,i.canvas.height),ht.set(0,0,i.canvas.width,i.canvas.height),r.reset(),o.reset(),a.reset()}return{buffers:{color:r,depth:o,stencil:a},enable:vt,disable:Bt,bindFramebuffer:ye,drawBuffers:kt,useProgram:jt,setBlending:ut,setMaterial:at,setFlipSided:Tt,setCullFace:yt,setLineWidth:Jt,setPolygonOffset:Ut,setScissorTest:re,activeTexture:oe,bindTexture:de,unbindTexture:N,compressedTexImage2D:Oe,compressedTexImage3D:ie,texImage2D:v,texImage3D:B,pixelStorei:K,getParameter:it,updateUBOMapping:Z,uniformBlockBinding:J,texStorage2D:qt,texStorage3D:C,texSubImage2D:be,texSubImage3D:gt,compressedTexSubImage2D:Le,compressedTexSubImage3D:Gt,scissor:lt,viewport:_t,reset:dt}}function pM(i,t,e,n,s,r,o){let a=t.has("WEBGL_multisampled_render_to_texture")?t.get("WEBGL_multisampled_render_to_texture"):null,l=typeof navigator>"u"?!1:/OculusBrowser/g.test(navigator.userAgent),c=new rt,h=new WeakMap,u=new Set,d,f=new WeakMap,m=new Set,x=new FinalizationRegistry(C=>m.delete(C)),p=!1;try{p=typeof OffscreenCanvas<"u"&&new OffscreenCanvas(1,1).getContext("2d")!==null}catch{}function g(C,v){return p?new OffscreenCanvas(C,v):Pr("canvas")}function y(C,v,B){let it=1,K=qt(C);if((K.width>B||K.height>B)&&(it=B/Math.max(K.width,K.height)),it<1)if(typeof HTMLImageElement<"u"&&C instanceof HTMLImageElement||typeof HTMLCanvasElement<"u"&&C instanceof HTMLCanvasElement||typeof ImageBitmap<"u"&&C instanceof ImageBitmap||typeof VideoFrame<"u"&&C instanceof VideoFrame){let lt=Math.floor(it*K.width),_t=Math.floor(it*K.height);d===void 0&&(d=g(lt,_t));let Z=v?g(lt,_t):d;return Z.width=lt,Z.height=_t,Z.getContext("2d").drawImage(C,0,0,lt,_t),Vt("WebGLRenderer: Texture has been resized from ("+K.width+"x"+K.height+") to ("+lt+"x"+_t+")."),Z}else return"data"in C&&Vt("WebGLRenderer: Image in DataTexture is too big ("+K.width+"x"+K.height+")."),C;return C}function w(C){return C.generateMipmaps}function S(C){i.generateMipmap(C)}function T(C){return C.isWebGLCubeRenderTarget?i.TEXTURE_CUBE_MAP:C.isWebGL3DRenderTarget?i.TEXTURE_3D:C.isWebGLArrayRenderTarget||C.isCompressedArrayTexture?i.TEXTURE_2D_ARRAY:i.TEXTURE_2D}function A(C,v,B,it,K,lt=!1){if(C!==null){if(i[C]!==void 0)return i[C];Vt("WebGLRenderer: Attempt to use non-existing WebGL internal format '"+C+"'")}let _t;it&&(_t=t.get("EXT_texture_norm16"),_t||Vt("WebGLRenderer: Unable to use normalized textures without EXT_texture_norm16 extension"));let Z=v;if(v===i.RED&&(B===i.FLOAT&&(Z=i.R32F),B===i.HALF_FLOAT&&(Z=i.R16F),B===i.UNSIGNED_BYTE&&(Z=i.R8),B===i.UNSIGNED_SHORT&&_t&&(Z=_t.R16_EXT),B===i.SHORT&&_t&&(Z=_t.R16_SNORM_EXT)),v===i.RED_INTEGER&&(B===i.UNSIGNED_BYTE&&(Z=i.R8UI),B===i.UNSIGNED_SHORT&&(Z=i.R16UI),B===i.UNSIGNED_INT&&(Z=i.R32UI),B===i.BYTE&&(Z=i.R8I),B===i.SHORT&&(Z=i.R16I),B===i.INT&&(Z=i.R32I)),v===i.RG&&(B===i.FLOAT&&(Z=i.RG32F),B===i.HALF_FLOAT&&(Z=i.RG16F),B===i.UNSIGNED_BYTE&&(Z=i.RG8),B===i.UNSIGNED_SHORT&&_t&&(Z=_t.RG16_EXT),B===i.SHORT&&_t&&(Z=_t.RG16_SNORM_EXT)),v===i.RG_INTEGER&&(B===i.UNSIGNED_BYTE&&(Z=i.RG8UI),B===i.UNSIGNED_SHORT&&(Z=i.RG16UI),B===i.UNSIGNED_INT&&(Z=i.RG32UI),B===i.BYTE&&(Z=i.RG8I),B===i.SHORT&&(Z=i.RG16I),B===i.INT&&(Z=i.RG32I)),v===i.RGB_INTEGER&&(B===i.UNSIGNED_BYTE&&(Z=i.RGB8UI),B===i.UNSIGNED_SHORT&&(Z=i.RGB16UI),B===i.UNSIGNED_INT&&(Z=i.RGB32UI),B===i.BYTE&&(Z=i.RGB8I),B===i.SHORT&&(Z=i.RGB16I),B===i.INT&&(Z=i.RGB32I)),v===i.RGBA_INTEGER&&(B===i.UNSIGNED_BYTE&&(Z=i.RGBA8UI),B===i.UNSIGNED_SHORT&&(Z=i.RGBA16UI),B===i.UNSIGNED_INT&&(Z=i.RGBA32UI),B===i.BYTE&&(Z=i.RGBA8I),B===i.SHORT&&(Z=i.RGBA16I),B===i.INT&&(Z=i.RGBA32I)),v===i.RGB&&(B===i.UNSIGNED_SHORT&&_t&&(Z=_t.RGB16_EXT),B===i.SHORT&&_t&&(Z=_t.RGB16_SNORM_EXT),B===i.UNSIGNED_INT_5_9_9_9_REV&&(Z=i.RGB9_E5),B===i.UNSIGNED_INT_10F_11F_11F_REV&&(Z=i.R11F_G11F_B10F)),v===i.RGBA){let J=lt?Cr:se.getTransfer(K);B===i.FLOAT&&(Z=i.RGBA32F),B===i.HALF_FLOAT&&(Z=i.RGBA16F),B===i.UNSIGNED_BYTE&&(Z=J===_e?i.SRGB8_ALPHA8:i.RGBA8),B===i.UNSIGNED_SHORT&&_t&&(Z=_t.RGBA16_EXT),B===i.SHORT&&_t&&(Z=_t.RGBA16_SNORM_EXT),B===i.UNSIGNED_SHORT_4_4_4_4&&(Z=i.RGBA4),B===i.UNSIGNED_SHORT_5_5_5_1&&(Z=i.RGB5_A1)}return(Z===i.R16F||Z===i.R32F||Z===i.RG16F||Z===i.RG32F||Z===i.RGBA16F||Z===i.RGBA32F)&&t.get("EXT_color_buffer_float"),Z}function _(C,v){let B;return C?v===null||v===kn||v===hs?B=i.DEPTH24_STENCIL8:v===fn?B=i.DEPTH32F_STENCIL8:v===Js&&(B=i.DEPTH24_STENCIL8,Vt("DepthTexture: 16 bit depth attachment is not supported with stencil. Using 24-bit attachment.")):v===null||v===kn||v===hs?B=i.DEPTH_COMPONENT24:v===fn?B=i.DEPTH_COMPONENT32F:v===Js&&(B=i.DEPTH_COMPONENT16),B}function E(C,v){return w(C)===!0||C.isFramebufferTexture&&C.minFilter!==Ne&&C.minFilter!==Ye?Math.log2(Math.max(v.width,v.height))+1:C.mipmaps.length>0?C.mipmaps.length:C.isCompressedTexture&&Array.isArray(C.image)?v.mipmaps.length:1}function O(C){let v=new WeakRef(C);n.get(C).__ref=v,m.add(v),x.register(C,v,v)}function P(C){let v=n.get(C).__ref;v!==void 0&&(m.delete(v),x.unregister(v))}function U(C){$(C.target)}function G(C){L(C.target)}function $(C){C.removeEventListener("dispose",U),P(C),X(C),C.isVideoTexture&&h.delete(C),C.isHTMLTexture&&u.delete(C)}function L(C){C.removeEventListener("dispose",G),P(C),nt(C)}function V(){for(let C of m){let v=C.deref();v!==void 0&&(v.isRenderTarget===!0?L(v):$(v))}m.clear(),u.clear()}function X(C){let v=n.get(C);if(v.__webglInit===void 0)return;let B=C.source,it=f.get(B);if(it){let K=it[v.__cacheKey];K.usedTimes--,K.usedTimes===0&&z(C),Object.keys(it).length===0&&f.delete(B)}n.remove(C)}function z(C){let v=n.get(C);i.deleteTexture(v.__webglTexture);let B=C.source,it=f.get(B);delete it[v.__cacheKey],o.memory.textures--}function nt(C){let v=n.get(C);v.__depthDisposeCallback&&v.__depthDisposeCallback();let B=C.depthTexture;if(B&&B.renderTarget===C&&$(B),C.isWebGLCubeRenderTarget)for(let K=0;K<6;K++){if(Array.isArray(v.__webglFramebuffer[K]))for(let lt=0;lt<v.__webglFramebuffer[K].length;lt++)i.deleteFramebuffer(v.__webglFramebuffer[K][lt]);else i.deleteFramebuffer(v.__webglFramebuffer[K]);v.__webglDepthbuffer&&i.deleteRenderbuffer(v.__webglDepthbuffer[K])}else{if(Array.isArray(v.__webglFramebuffer))for(let K=0;K<v.__webglFramebuffer.length;K++)i.deleteFramebuffer(v.__webglFramebuffer[K]);else i.deleteFramebuffer(v.__webglFramebuffer);if(v.__webglDepthbuffer&&i.deleteRenderbuffer(v.__webglDepthbuffer),v.__webglMultisampledFramebuffer&&i.deleteFramebuffer(v.__webglMultisampledFramebuffer),v.__webglColorRenderbuffer)for(let K=0;K<v.__webglColorRenderbuffer.length;K++)v.__webglColorRenderbuffer[K]&&i.deleteRenderbuffer(v.__webglColorRenderbuffer[K]);v.__webglDepthRenderbuffer&&i.deleteRenderbuffer(v.__webglDepthRenderbuffer)}let it=C.textures;for(let K=0,lt=it.length;K<lt;K++){let _t=n.get(it[K]);_t.__webglTexture&&(i.deleteTexture(_t.__webglTexture),o.memory.textures--),n.remove(it[K])}n.remove(C)}let H=0;function Q(){H=0}function et(){return H}function Et(C){H=C}function Nt(){let C=H;return C>=s.maxTextures&&Vt("WebGLTextures: Trying to use "+(C+1)+" texture units while this GPU supports only "+s.maxTextures),H+=1,C}function Y(C){let v=[];return v.push(C.wrapS),v.push(C.wrapT),v.push(C.wrapR||0),v.push(C.magFilter),v.push(C.minFilter),v.push(C.anisotropy),v.push(C.internalFormat),v.push(C.format),v.push(C.type),v.push(C.generateMipmaps),v.push(C.mipmapsAutoUpdate),v.push(C.premultiplyAlpha),v.push(C.flipY),v.push(C.unpackAlignment),v.push(C.colorSpace),v.join()}function ht(C,v){let B=n.get(C);if(C.isVideoTexture&&Le(C),C.isRenderTargetTexture===!1&&C.isExternalTexture!==!0&&C.version>0&&B.__version!==C.version){let it=C.image;if(it===null)Vt("WebGLRenderer: Texture marked for update but no image data found.");else if(it.complete===!1)Vt("WebGLRenderer: Texture marked for update but image is incomplete");else{at(B,C,v);return}}else C.isExternalTexture&&(B.__webglTexture=C.sourceTexture?C.sourceTexture:null);e.bindTexture(i.TEXTURE_2D,B.__webglTexture,i.TEXTURE0+v)}function At(C,v){let B=n.get(C);if(C.isRenderTargetTexture===!1&&C.version>0&&B.__version!==C.version){at(B,C,v);return}else C.isExternalTexture&&(B.__webglTexture=C.sourceTexture?C.sourceTexture:null);e.bindTexture(i.TEXTURE_2D_ARRAY,B.__webglTexture,i.TEXTURE0+v)}function Ot(C,v){let B=n.get(C);if(C.isRenderTargetTexture===!1&&C.version>0&&B.__version!==C.version){at(B,C,v);return}e.bindTexture(i.TEXTURE_3D,B.__webglTexture,i.TEXTURE0+v)}function vt(C,v){let B=n.get(C);if(C.version>0&&B.__version!==C.version){Tt(B,C,v);return}e.bindTexture(i.TEXTURE_CUBE_MAP,B.__webglTexture,i.TEXTURE0+v)}let Bt={[Aa]:i.REPEAT,[Yn]:i.CLAMP_TO_EDGE,[Ta]:i.MIRRORED_REPEAT},ye={[Ne]:i.NEAREST,[Kf]:i.NEAREST_MIPMAP_NEAREST,[no]:i.NEAREST_MIPMAP_LINEAR,[Ye]:i.LINEAR,[al]:i.LINEAR_MIPMAP_NEAREST,[bi]:i.LINEAR_MIPMAP_LINEAR},kt={[ep]:i.NEVER,[iu]:i.ALWAYS,[np]:i.LESS,[eu]:i.LEQUAL,[ip]:i.EQUAL,[nu]:i.GEQUAL,[sp]:i.GREATER,[rp]:i.NOTEQUAL};function jt(C,v){if(v.type===fn&&t.has("OES_texture_float_linear")===!1&&(v.magFilter===Ye||v.magFilter===al||v.magFilter===no||v.magFilter===bi||v.minFilter===Ye||v.minFilter===al||v.minFilter===no||v.minFilter===bi)&&Vt("WebGLRenderer: Unable to use linear filtering with floating point textures. OES_texture_float_linear not supported on this device."),i.texParameteri(C,i.TEXTURE_WRAP_S,Bt[v.wrapS]),i.texParameteri(C,i.TEXTURE_WRAP_T,Bt[v.wrapT]),(C===i.TEXTURE_3D||C===i.TEXTURE_2D_ARRAY)&&i.texParameteri(C,i.TEXTURE_WRAP_R,Bt[v.wrapR]),i.texParameteri(C,i.TEXTURE_MAG_FILTER,ye[v.magFilter]),i.texParameteri(C,i.TEXTURE_MIN_FILTER,ye[v.minFilter]),v.compareFunction&&(i.texParameteri(C,i.TEXTURE_COMPARE_MODE,i.COMPARE_REF_TO_TEXTURE),i.texParameteri(C,i.TEXTURE_COMPARE_FUNC,kt[v.compareFunction])),t.has("EXT_texture_filter_anisotropic")===!0){if(v.magFilter===Ne||v.minFilter!==no&&v.minFilter!==bi||v.type===fn&&t.has("OES_texture_float_linear")===!1)return;if(v.anisotropy>1||n.get(v).__currentAnisotropy){let B=t.get("EXT_texture_filter_anisotropic");i.texParameterf(C,B.TEXTURE_MAX_ANISOTROPY_EXT,Math.min(v.anisotropy,s.getMaxAnisotropy())),n.get(v).__currentAnisotropy=v.anisotropy}}}function Qt(C,v){let B=!1;C.__webglInit===void 0&&(C.__webglInit=!0,v.addEventListener("dispose",U),O(v));let it=v.source,K=f.get(it);K===void 0&&(K={},f.set(it,K));let lt=Y(v);if(lt!==C.__cacheKey){K[lt]===void 0&&(K[lt]={texture:i.createTexture(),usedTimes:0},o.memory.textures++,B=!0),K[lt].usedTimes++;let _t=K[C.__cacheKey];_t!==void 0&&(K[C.__cacheKey].usedTimes--,_t.usedTimes===0&&z(v)),C.__cacheKey=lt,C.__webglTexture=K[lt].texture}return B}function tt(C,v,B){return Math.floor(Math.floor(C/B)/v)}function ut(C,v,B,it){let lt=C.updateRanges;if(lt.length===0)e.texSubImage2D(i.TEXTURE_2D,0,0,0,v.width,v.height,B,it,v.data);else{lt.sort((R,j)=>R.start-j.start);let _t=0;for(let R=1;R<lt.length;R++){let j=lt[_t],q=lt[R],ft=j.start+j.count,ot=tt(q.start,v.width,4),ct=tt(j.start,v.width,4);q.start<=ft+1&&ot===ct&&tt(q.start+q.count-1,v.width,4)===ot?j.count=Math.max(j.count,q.start+q.count-j.start):(++_t,lt[_t]=q)}lt.length=_t+1;let Z=e.getParameter(i.UNPACK_ROW_LENGTH),J=e.getParameter(i.UNPACK_SKIP_PIXELS),dt=e.getParameter(i.UNPACK_SKIP_ROWS);e.pixelStorei(i.UNPACK_ROW_LENGTH,v.width);for(let R=0,j=lt.length;R<j;R++){let q=lt[R],ft=Math.floor(q.start/4),ot=Math.ceil(q.count/4),ct=ft%v.width,Ft=Math.floor(ft/v.width),te=ot,st=1;e.pixelStorei(i.UNPACK_SKIP_PIXELS,ct),e.pixelStorei(i.UNPACK_SKIP_ROWS,Ft),e.texSubImage2D(i.TEXTURE_2D,0,ct,Ft,te,st,B,it,v.data)}C.clearUpdateRanges(),e.pixelStorei(i.UNPACK_ROW_LENGTH,Z),e.pixelStorei(i.UNPACK_SKIP_PIXELS,J),e.pixelStorei(i.UNPACK_SKIP_ROWS,dt)}}function at(C,v,B){let it=i.TEXTURE_2D;(v.isDataArrayTexture||v.isCompressedArrayTexture)&&(it=i.TEXTURE_2D_ARRAY),v.isData3DTexture&&(it=i.TEXTURE_3D);let K=Qt(C,v),lt=v.source;e.bindTexture(it,C.__webglTexture,i.TEXTURE0+B);let _t=n.get(lt);if(lt.version!==_t.__version||K===!0){if(e.activeTexture(i.TEXTURE0+B),(typeof ImageBitmap<"u"&&v.image instanceof ImageBitmap)===!1){let st=se.getPrimaries(se.workingColorSpace),zt=v.colorSpace===Si?null:se.getPrimaries(v.colorSpace),Kt=v.colorSpace===Si||st===zt?i.NONE:i.BROWSER_DEFAULT_WEBGL;e.pixelStorei(i.UNPACK_FLIP_Y_WEBGL,v.flipY),e.pixelStorei(i.UNPACK_PREMULTIPLY_ALPHA_WEBGL,v.premultiplyAlpha),e.pixelStorei(i.UNPACK_COLORSPACE_CONVERSION_WEBGL,Kt)}e.pixelStorei(i.UNPACK_ALIGNMENT,v.unpackAlignment);let J=y(v.image,!1,s.maxTextureSize);J=Gt(v,J);let dt=r.convert(v.format,v.colorSpace),R=r.convert(v.type),j=A(v.internalFormat,dt,R,v.normalized,v.colorSpace,v.isVideoTexture);jt(it,v);let q,ft=v.mipmaps,ot=v.isVideoTexture!==!0,ct=_t.__version===void 0||K===!0,Ft=lt.dataReady,te=E(v,J);if(v.isDepthTexture)j=_(v.format===Mi,v.type),ct&&(ot?e.texStorage2D(i.TEXTURE_2D,1,j,J.width,J.height):e.texImage2D(i.TEXTURE_2D,0,j,J.width,J.height,0,dt,R,null));else if(v.isDataTexture)if(ft.length>0){ot&&ct&&e.texStorage2D(i.TEXTURE_2D,te,j,ft[0].width,ft[0].height);for(let st=0,zt=ft.length;st<zt;st++)q=ft[st],ot?Ft&&e.texSubImage2D(i.TEXTURE_2D,st,0,0,q.width,q.height,dt,R,q.data):e.texImage2D(i.TEXTURE_2D,st,j,q.width,q.height,0,dt,R,q.data);v.generateMipmaps=!1}else ot?(ct&&e.texStorage2D(i.TEXTURE_2D,te,j,J.width,J.height),Ft&&ut(v,J,dt,R)):e.texImage2D(i.TEXTURE_2D,0,j,J.width,J.height,0,dt,R,J.data);else if(v.isCompressedTexture)if(v.isCompressedArrayTexture){ot&&ct&&e.texStorage3D(i.TEXTURE_2D_ARRAY,te,j,ft[0].width,ft[0].height,J.depth);for(let st=0,zt=ft.length;st<zt;st++)if(q=ft[st],v.format!==Sn)if(dt!==null)if(ot){if(Ft)if(v.layerUpdates.size>0){let Kt=fu(q.width,q.height,v.format,v.type);for(let bt of v.layerUpdates){let xe=q.data.subarray(bt*Kt/q.data.BYTES_PER_ELEMENT,(bt+1)*Kt/q.data.BYTES_PER_ELEMENT);e.compressedTexSubImage3D(i.TEXTURE_2D_ARRAY,st,0,0,bt,q.width,q.height,1,dt,xe)}}else e.compressedTexSubImage3D(i.TEXTURE_2D_ARRAY,st,0,0,0,q.width,q.height,J.depth,dt,q.data)}else e.compressedTexImage3D(i.TEXTURE_2D_ARRAY,st,j,q.width,q.height,J.depth,0,q.data,0,0);else Vt("WebGLRenderer: Attempt to load unsupported compressed texture format in .uploadTexture()");else ot?Ft&&e.texSubImage3D(i.TEXTURE_2D_ARRAY,st,0,0,0,q.width,q.height,J.depth,dt,R,q.data):e.texImage3D(i.TEXTURE_2D_ARRAY,st,j,q.width,q.height,J.depth,0,dt,R,q.data);v.layerUpdates.size>0&&v.clearLayerUpdates()}else{ot&&ct&&e.texStorage2D(i.TEXTURE_2D,te,j,ft[0].width,ft[0].height);for(let st=0,zt=ft.length;st<zt;st++)q=ft[st],v.format!==Sn?dt!==null?ot?Ft&&e.compressedTexSubImage2D(i.TEXTURE_2D,st,0,0,q.width,q.height,dt,q.data):e.compressedTexImage2D(i.TEXTURE_2D,st,j,q.width,q.height,0,q.data):Vt("WebGLRenderer: Attempt to load unsupported compressed texture format in .uploadTexture()"):ot?Ft&&e.texSubImage2D(i.TEXTURE_2D,st,0,0,q.width,q.height,dt,R,q.data):e.texImage2D(i.TEXTURE_2D,st,j,q.width,q.height,0,dt,R,q.data)}else if(v.isDataArrayTexture)if(ot){if(ct&&e.texStorage3D(i.TEXTURE_2D_ARRAY,te,j,J.width,J.height,J.depth),Ft)if(v.layerUpdates.size>0){let st=fu(J.width,J.height,v.format,v.type);for(let zt of v.layerUpdates){let Kt=J.data.subarray(zt*st/J.data.BYTES_PER_ELEMENT,(zt+1)*st/J.data.BYTES_PER_ELEMENT);e.texSubImage3D(i.TEXTURE_2D_ARRAY,0,0,0,zt,J.width,J.height,1,dt,R,Kt)}v.clearLayerUpdates()}else e.texSubImage3D(i.TEXTURE_2D_ARRAY,0,0,0,0,J.width,J.height,J.depth,dt,R,J.data)}else e.texImage3D(i.TEXTURE_2D_ARRAY,0,j,J.width,J.height,J.depth,0,dt,R,J.data);else if(v.isData3DTexture)ot?(ct&&e.texStorage3D(i.TEXTURE_3D,te,j,J.width,J.height,J.depth),Ft&&e.texSubImage3D(i.TEXTURE_3D,0,0,0,0,J.width,J.height,J.depth,dt,R,J.data)):e.texImage3D(i.TEXTURE_3D,0,j,J.width,J.height,J.depth,0,dt,R,J.data);else if(v.isFramebufferTexture){if(ct)if(ot)e.texStorage2D(i.TEXTURE_2D,te,j,J.width,J.height);else{let st=J.width,zt=J.height;for(let Kt=0;Kt<te;Kt++)e.texImage2D(i.TEXTURE_2D,Kt,j,st,zt,0,dt,R,null),st>>=1,zt>>=1}}else if(v.isHTMLTexture){if("texElementImage2D"in i){let st=i.canvas;if(st.hasAttribute("layoutsubtree")||st.setAttribute("layoutsubtree","true"),J.parentNode!==st){st.appendChild(J),u.add(v),st.onpaint=zt=>{let Kt=zt.changedElements;for(let bt of u)Kt.includes(bt.image)&&(bt.needsUpdate=!0)},st.requestPaint();return}if(i.texElementImage2D.length===3)i.texElementImage2D(i.TEXTURE_2D,i.RGBA8,J);else{let Kt=i.RGBA,bt=i.RGBA,xe=i.UNSIGNED_BYTE;i.texElementImage2D(i.TEXTURE_2D,0,Kt,bt,xe,J)}i.texParameteri(i.TEXTURE_2D,i.TEXTURE_MIN_FILTER,i.LINEAR),i.texParameteri(i.TEXTURE_2D,i.TEXTURE_WRAP_S,i.CLAMP_TO_EDGE),i.texParameteri(i.TEXTURE_2D,i.TEXTURE_WRAP_T,i.CLAMP_TO_EDGE)}}else if(ft.length>0){if(ot&&ct){let st=qt(ft[0]);e.texStorage2D(i.TEXTURE_2D,te,j,st.width,st.height)}for(let st=0,zt=ft.length;st<zt;st++)q=ft[st],ot?Ft&&e.texSubImage2D(i.TEXTURE_2D,st,0,0,dt,R,q):e.texImage2D(i.TEXTURE_2D,st,j,dt,R,q);v.generateMipmaps=!1}else if(ot){if(ct){let st=qt(J);e.texStorage2D(i.TEXTURE_2D,te,j,st.width,st.height)}Ft&&e.texSubImage2D(i.TEXTURE_2D,0,0,0,dt,R,J)}else e.texImage2D(i.TEXTURE_2D,0,j,dt,R,J);w(v)&&v.mipmapsAutoUpdate===!0&&S(it),_t.__version=lt.version,v.onUpdate&&v.onUpdate(v)}C.__version=v.version}function Tt(C,v,B){if(v.image.length!==6)return;let it=Qt(C,v),K=v.source;e.bindTexture(i.TEXTURE_CUBE_MAP,C.__webglTexture,i.TEXTURE0+B);let lt=n.get(K);if(K.version!==lt.__version||it===!0){e.activeTexture(i.TEXTURE0+B);let _t=se.getPrimaries(se.workingColorSpace),Z=v.colorSpace===Si?null:se.getPrimaries(v.colorSpace),J=v.colorSpace===Si||_t===Z?i.NONE:i.BROWSER_DEFAULT_WEBGL;e.pixelStorei(i.UNPACK_FLIP_Y_WEBGL,v.flipY),e.pixelStorei(i.UNPACK_PREMULTIPLY_ALPHA_WEBGL,v.premultiplyAlpha),e.pixelStorei(i.UNPACK_ALIGNMENT,v.unpackAlignment),e.pixelStorei(i.UNPACK_COLORSPACE_CONVERSION_WEBGL,J);let dt=v.isCompressedTexture||v.image[0].isCompressedTexture,R=v.image[0]&&v.image[0].isDataTexture,j=[];for(let bt=0;bt<6;bt++)!dt&&!R?j[bt]=y(v.image[bt],!0,s.maxCubemapSize):j[bt]=R?v.image[bt].image:v.image[bt],j[bt]=Gt(v,j[bt]);let q=j[0],ft=r.convert(v.format,v.colorSpace),ot=r.convert(v.type),ct=A(v.internalFormat,ft,ot,v.normalized,v.colorSpace),Ft=v.isVideoTexture!==!0,te=lt.__version===void 0||it===!0,st=K.dataReady,zt=E(v,q);jt(i.TEXTURE_CUBE_MAP,v);let Kt;if(v.isDepthTexture){if(ct=_(v.format===Mi,v.type),te)if(Ft)e.texStorage2D(i.TEXTURE_CUBE_MAP,1,ct,q.width,q.height);else for(let bt=0;bt<6;bt++)e.texImage2D(i.TEXTURE_CUBE_MAP_POSITIVE_X+bt,0,ct,q.width,q.height,0,ft,ot,null)}else if(dt){Ft&&te&&e.texStorage2D(i.TEXTURE_CUBE_MAP,zt,ct,q.width,q.height);for(let bt=0;bt<6;bt++){Kt=j[bt].mipmaps;for(let xe=0;xe<Kt.length;xe++){let Xe=Kt[xe];v.format!==Sn?ft!==null?Ft?st&&e.compressedTexSubImage2D(i.TEXTURE_CUBE_MAP_POSITIVE_X+bt,xe,0,0,Xe.width,Xe.height,ft,Xe.data):e.compressedTexImage2D(i.TEXTURE_CUBE_MAP_POSITIVE_X+bt,xe,ct,Xe.width,Xe.height,0,Xe.data):Vt("WebGLRenderer: Attempt to load unsupported compressed texture format in .setTextureCube()"):Ft?st&&e.texSubImage2D(i.TEXTURE_CUBE_MAP_POSITIVE_X+bt,xe,0,0,Xe.width,Xe.height,ft,ot,Xe.data):e.texImage2D(i.TEXTURE_CUBE_MAP_POSITIVE_X+bt,xe,ct,Xe.width,Xe.height,0,ft,ot,Xe.data)}}}else{if(Kt=v.mipmaps,Ft&&te){Kt.length>0&&zt++;let bt=qt(j[0]);e.texStorage2D(i.TEXTURE_CUBE_MAP,zt,ct,bt.width,bt.height)}for(let bt=0;bt<6;bt++)if(R){Ft?st&&e.texSubImage2D(i.TEXTURE_CUBE_MAP_POSITIVE_X+bt,0,0,0,j[bt].width,j[bt].height,ft,ot,j[bt].data):e.texImage2D(i.TEXTURE_CUBE_MAP_POSITIVE_X+bt,0,ct,j[bt].width,j[bt].height,0,ft,ot,j[bt].data);for(let xe=0;xe<Kt.length;xe++){let Ei=Kt[xe].image[bt].image;Ft?st&&e.texSubImage2D(i.TEXTURE_CUBE_MAP_POSITIVE_X+bt,xe+1,0,0,Ei.width,Ei.height,ft,ot,Ei.data):e.texImage2D(i.TEXTURE_CUBE_MAP_POSITIVE_X+bt,xe+1,ct,Ei.width,Ei.height,0,ft,ot,Ei.data)}}else{Ft?st&&e.texSubImage2D(i.TEXTURE_CUBE_MAP_POSITIVE_X+bt,0,0,0,ft,ot,j[bt]):e.texImage2D(i.TEXTURE_CUBE_MAP_POSITIVE_X+bt,0,ct,ft,ot,j[bt]);for(let xe=0;xe<Kt.length;xe++){let Xe=Kt[xe];Ft?st&&e.texSubImage2D(i.TEXTURE_CUBE_MAP_POSITIVE_X+bt,xe+1,0,0,ft,ot,Xe.image[bt]):e.texImage2D(i.TEXTURE_CUBE_MAP_POSITIVE_X+bt,xe+1,ct,ft,ot,Xe.image[bt])}}}w(v)&&v.mipmapsAutoUpdate===!0&&S(i.TEXTURE_CUBE_MAP),lt.__version=K.version,v.onUpdate&&v.onUpdate(v)}C.__version=v.version}function yt(C,v,B,it,K,lt){let _t=r.convert(B.format,B.colorSpace),Z=r.convert(B.type),J=A(B.internalFormat,_t,Z,B.normalized,B.colorSpace),dt=n.get(v),R=n.get(B);if(R.__renderTarget=v,!dt.__hasExternalTextures){let j=Math.max(1,v.width>>lt),q=Math.max(1,v.height>>lt);K===i.TEXTURE_3D||K===i.TEXTURE_2D_ARRAY?e.texImage3D(K,lt,J,j,q,v.depth,0,_t,Z,null):e.texImage2D(K,lt,J,j,q,0,_t,Z,null)}e.bindFramebuffer(i.FRAMEBUFFER,C),gt(v)?a.framebufferTexture2DMultisampleEXT(i.FRAMEBUFFER,it,K,R.__webglTexture,0,be(v)):(K===i.TEXTURE_2D||K>=i.TEXTURE_CUBE_MAP_POSITIVE_X&&K<=i.TEXTURE_CUBE_MAP_NEGATIVE_Z)&&i.framebufferTexture2D(i.FRAMEBUFFER,it,K,R.__webglTexture,lt),e.bindFramebuffer(i.FRAMEBUFFER,null)}function Jt(C,v,B){if(i.bindRenderbuffer(i.RENDERBUFFER,C),v.depthBuffer){let it=v.depthTexture,K=it&&it.isDepthTexture?it.type:null,lt=_(v.stencilBuffer,K),_t=v.stencilBuffer?i.DEPTH_STENCIL_ATTACHMENT:i.DEPTH_ATTACHMENT;gt(v)?a.renderbufferStorageMultisampleEXT(i.RENDERBUFFER,be(v),lt,v.width,v.height):B?i.renderbufferStorageMultisample(i.RENDERBUFFER,be(v),lt,v.width,v.height):i.renderbufferStorage(i.RENDERBUFFER,lt,v.width,v.height),i.framebufferRenderbuffer(i.FRAMEBUFFER,_t,i.RENDERBUFFER,C)}else{let it=v.textures;for(let K=0;K<it.length;K++){let lt=it[K],_t=r.convert(lt.format,lt.colorSpace),Z=r.convert(lt.type),J=A(lt.internalFormat,_t,Z,lt.normalized,lt.colorSpace);gt(v)?a.renderbufferStorageMultisampleEXT(i.RENDERBUFFER,be(v),J,v.width,v.height):B?i.renderbufferStorageMultisample(i.RENDERBUFFER,be(v),J,v.width,v.height):i.renderbufferStorage(i.RENDERBUFFER,J,v.width,v.height)}}i.bindRenderbuffer(i.RENDERBUFFER,null)}function Ut(C,v,B){let it=v.isWebGLCubeRenderTarget===!0;if(e.bindFramebuffer(i.FRAMEBUFFER,C),!(v.depthTexture&&v.depthTexture.isDepthTexture))throw new Error("THREE.WebGLTextures: renderTarget.depthTexture must be an instance of THREE.DepthTexture.");let K=n.get(v.depthTexture);K.__renderTarget=v;let lt=it?v.depthTexture.image[0]:v.depthTexture.image;(!K.__webglTexture||lt.width!==v.width||lt.height!==v.height)&&(lt.width=v.width,lt.height=v.height,v.depthTexture.needsUpdate=!0),it?vt(v.depthTexture,0):ht(v.depthTexture,0);let _t=K.__webglTexture,Z=be(v),J=it?i.TEXTURE_CUBE_MAP_POSITIVE_X+B:i.TEXTURE_2D,dt=v.depthTexture.format===Mi?i.DEPTH_STENCIL_ATTACHMENT:i.DEPTH_ATTACHMENT;if(v.depthTexture.format===gi)gt(v)?a.framebufferTexture2DMultisampleEXT(i.FRAMEBUFFER,dt,J,_t,0,Z):i.framebufferTexture2D(i.FRAMEBUFFER,dt,J,_t,0);else if(v.depthTexture.format===Mi)gt(v)?a.framebufferTexture2DMultisampleEXT(i.FRAMEBUFFER,dt,J,_t,0,Z):i.framebufferTexture2D(i.FRAMEBUFFER,dt,J,_t,0);else throw new Error("THREE.WebGLTextures: Unknown depthTexture format.")}function re(C){let v=n.get(C),B=C.isWebGLCubeRenderTarget===!0;if(v.__boundDepthTexture!==C.depthTexture){let it=C.depthTexture;if(v.__depthDisposeCallback&&v.__depthDisposeCallback(),it){let K=()=>{delete v.__boundDepthTexture,delete v.__depthDisposeCallback,it.removeEventListener("dispose",K)};it.addEventListener("dispose",K),v.__depthDisposeCallback=K}v.__boundDepthTexture=it}if(C.depthTexture&&!v.__autoAllocateDepthBuffer)if(B)for(let it=0;it<6;it++)Ut(v.__webglFramebuffer[it],C,it);else C.texture.mipmaps.length>0?Ut(v.__webglFramebuffer[0],C,0):Ut(v.__webglFramebuffer,C,0);else if(B){v.__webglDepthbuffer=[];for(let it=0;it<6;it++)if(e.bindFramebuffer(i.FRAMEBUFFER,v.__webglFramebuffer[it]),v.__webglDepthbuffer[it]===void 0)v.__webglDepthbuffer[it]=i.createRenderbuffer(),Jt(v.__webglDepthbuffer[it],C,!1);else{let K=C.stencilBuffer?i.DEPTH_STENCIL_ATTACHMENT:i.DEPTH_ATTACHMENT,lt=v.__webglDepthbuffer[it];i.bindRenderbuffer(i.RENDERBUFFER,lt),i.framebufferRenderbuffer(i.FRAMEBUFFER,K,i.RENDERBUFFER,lt)}}else if(C.texture.mipmaps.length>0?e.bindFramebuffer(i.FRAMEBUFFER,v.__webglFramebuffer[0]):e.bindFramebuffer(i.FRAMEBUFFER,v.__webglFramebuffer),v.__webglDepthbuffer===void 0)v.__webglDepthbuffer=i.createRenderbuffer(),Jt(v.__webglDepthbuffer,C,!1);else{let K=C.stencilBuffer?i.DEPTH_STENCIL_ATTACHMENT:i.DEPTH_ATTACHMENT,lt=v.__webglDepthbuffer;i.bindRenderbuffer(i.RENDERBUFFER,lt),i.framebufferRenderbuffer(i.FRAMEBUFFER,K,i.RENDERBUFFER,lt)}e.bindFramebuffer(i.FRAMEBUFFER,null)}function oe(C,v,B){let it=n.get(C);v!==void 0&&yt(it.__webglFramebuffer,C,C.texture,i.COLOR_ATTACHMENT0,i.TEXTURE_2D,0),B!==void 0&&re(C)}function de(C){let v=C.texture,B=n.get(C),it=n.get(v);C.addEventListener("dispose",G),O(C);let K=C.textures,lt=C.isWebGLCubeRenderTarget===!0,_t=K.length>1;if(_t||(it.__webglTexture===void 0&&(it.__webglTexture=i.createTexture()),it.__version=v.version,o.memory.textures++),lt){B.__webglFramebuffer=[];for(let Z=0;Z<6;Z++)if(v.mipmaps.length>0){B.__webglFramebuffer[Z]=[];for(let J=0;J<v.mipmaps.length;J++)B.__webglFramebuffer[Z][J]=i.createFramebuffer()}else B.__webglFramebuffer[Z]=i.createFramebuffer()}else{if(v.mipmaps.length>0){B.__webglFramebuffer=[];for(let Z=0;Z<v.mipmaps.length;Z++)B.__webglFramebuffer[Z]=i.createFramebuffer()}else B.__webglFramebuffer=i.createFramebuffer();if(_t)for(let Z=0,J=K.length;Z<J;Z++){let dt=n.get(K[Z]);dt.__webglTexture===void 0&&(dt.__webglTexture=i.createTexture(),o.memory.textures++)}if(C.samples>0&&gt(C)===!1){B.__webglMultisampledFramebuffer=i.createFramebuffer(),B.__webglColorRenderbuffer=[],e.bindFramebuffer(i.FRAMEBUFFER,B.__webglMultisampledFramebuffer);for(let Z=0;Z<K.length;Z++){let J=K[Z];B.__webglColorRenderbuffer[Z]=i.createRenderbuffer(),i.bindRenderbuffer(i.RENDERBUFFER,B.__webglColorRenderbuffer[Z]);let dt=r.convert(J.format,J.colorSpace),R=r.convert(J.type),j=A(J.internalFormat,dt,R,J.normalized,J.colorSpace,C.isXRRenderTarget===!0),q=be(C);i.renderbufferStorageMultisample(i.RENDERBUFFER,q,j,C.width,C.height),i.framebufferRenderbuffer(i.FRAMEBUFFER,i.COLOR_ATTACHMENT0+Z,i.RENDERBUFFER,B.__webglColorRenderbuffer[Z])}i.bindRenderbuffer(i.RENDERBUFFER,null),C.depthBuffer&&(B.__webglDepthRenderbuffer=i.createRenderbuffer(),Jt(B.__webglDepthRenderbuffer,C,!0)),e.bindFramebuffer(i.FRAMEBUFFER,null)}}if(lt){e.bindTexture(i.TEXTURE_CUBE_MAP,it.__webglTexture),jt(i.TEXTURE_CUBE_MAP,v);for(let Z=0;Z<6;Z++)if(v.mipmaps.length>0)for(let J=0;J<v.mipmaps.length;J++)yt(B.__webglFramebuffer[Z][J],C,v,i.COLOR_ATTACHMENT0,i.TEXTURE_CUBE_MAP_POSITIVE_X+Z,J);else yt(B.__webglFramebuffer[Z],C,v,i.COLOR_ATTACHMENT0,i.TEXTURE_CUBE_MAP_POSITIVE_X+Z,0);w(v)?S(i.TEXTURE_CUBE_MAP):v.mipmaps.length>0&&i.texParameteri(i.TEXTURE_CUBE_MAP,i.TEXTURE_MAX_LEVEL,v.mipmaps.length-1),e.unbindTexture()}else if(_t){for(let Z=0,J=K.length;Z<J;Z++){let dt=K[Z],R=n.get(dt),j=i.TEXTURE_2D;(C.isWebGL3DRenderTarget||C.isWebGLArrayRenderTarget)&&(j=C.isWebGL3DRenderTarget?i.TEXTURE_3D:i.TEXTURE_2D_ARRAY),e.bindTexture(j,R.__webglTexture),jt(j,dt),yt(B.__webglFramebuffer,C,dt,i.COLOR_ATTACHMENT0+Z,j,0),w(dt)&&S(j)}e.unbindTexture()}else{let Z=i.TEXTURE_2D;if((C.isWebGL3DRenderTarget||C.isWebGLArrayRenderTarget)&&(Z=C.isWebGL3DRenderTarget?i.TEXTURE_3D:i.TEXTURE_2D_ARRAY),e.bindTexture(Z,it.__webglTexture),jt(Z,v),v.mipmaps.length>0)for(let J=0;J<v.mipmaps.length;J++)yt(B.__webglFramebuffer[J],C,v,i.COLOR_ATTACHMENT0,Z,J);else yt(B.__webglFramebuffer,C,v,i.COLOR_ATTACHMENT0,Z,0);w(v)?S(Z):v.mipmaps.length>0&&i.texParameteri(Z,i.TEXTURE_MAX_LEVEL,v.mipmaps.length-1),e.unbindTexture()}C.depthBuffer&&re(C)}function N(C){let v=C.textures;for(let B=0,it=v.length;B<it;B++){let K=v[B];if(w(K)&&K.mipmapsAutoUpdate===!0){let lt=T(C),_t=n.get(K).__webglTexture;e.bindTexture(lt,_t),S(lt),e.unbindTexture()}}}let Oe=[];function ie(C){if(C.samples>0){if(gt(C)===!1){let v=C.textures,B=C.width,it=C.height,K=i.COLOR_BUFFER_BIT,lt=C.stencilBuffer?i.DEPTH_STENCIL_ATTACHMENT:i.DEPTH_ATTACHMENT,_t=n.get(C),Z=v.length>1;if(Z)for(let dt=0;dt<v.length;dt++)e.bindFramebuffer(i.FRAMEBUFFER,_t.__webglMultisampledFramebuffer),i.framebufferRenderbuffer(i.FRAMEBUFFER,i.COLOR_ATTACHMENT0+dt,i.RENDERBUFFER,null),e.bindFramebuffer(i.FRAMEBUFFER,_t.__webglFramebuffer),i.framebufferTexture2D(i.DRAW_FRAMEBUFFER,i.COLOR_ATTACHMENT0+dt,i.TEXTURE_2D,null,0);e.bindFramebuffer(i.READ_FRAMEBUFFER,_t.__webglMultisampledFramebuffer),C.texture.mipmaps.length>0?e.bindFramebuffer(i.DRAW_FRAMEBUFFER,_t.__webglFramebuffer[0]):e.bindFramebuffer(i.DRAW_FRAMEBUFFER,_t.__webglFramebuffer);for(let dt=0;dt<v.length;dt++){if(C.resolveDepthBuffer&&(C.depthBuffer&&(K|=i.DEPTH_BUFFER_BIT),C.stencilBuffer&&C.resolveStencilBuffer&&(K|=i.STENCIL_BUFFER_BIT)),Z){i.framebufferRenderbuffer(i.READ_FRAMEBUFFER,i.COLOR_ATTACHMENT0,i.RENDERBUFFER,_t.__webglColorRenderbuffer[dt]);let R=n.get(v[dt]).__webglTexture;i.framebufferTexture2D(i.DRAW_FRAMEBUFFER,i.COLOR_ATTACHMENT0,i.TEXTURE_2D,R,0)}i.blitFramebuffer(0,0,B,it,0,0,B,it,K,i.NEAREST),l===!0&&(Oe.length=0,Oe.push(i.COLOR_ATTACHMENT0+dt),C.depthBuffer&&C.storeMultisampledDepthBuffer===!1&&Oe.push(lt),i.invalidateFramebuffer(i.READ_FRAMEBUFFER,Oe))}if(e.bindFramebuffer(i.READ_FRAMEBUFFER,null),e.bindFramebuffer(i.DRAW_FRAMEBUFFER,null),Z)for(let dt=0;dt<v.length;dt++){e.bindFramebuffer(i.FRAMEBUFFER,_t.__webglMultisampledFramebuffer),i.framebufferRenderbuffer(i.FRAMEBUFFER,i.COLOR_ATTACHMENT0+dt,i.RENDERBUFFER,_t.__webglColorRenderbuffer[dt]);let R=n.get(v[dt]).__webglTexture;e.bindFramebuffer(i.FRAMEBUFFER,_t.__webglFramebuffer),i.framebufferTexture2D(i.DRAW_FRAMEBUFFER,i.COLOR_ATTACHMENT0+dt,i.TEXTURE_2D,R,0)}e.bindFramebuffer(i.DRAW_FRAMEBUFFER,_t.__webglMultisampledFramebuffer)}else if(C.depthBuffer&&C.storeMultisampledDepthBuffer===!1&&l){let v=C.stencilBuffer?i.DEPTH_STENCIL_ATTACHMENT:i.DEPTH_ATTACHMENT;i.invalidateFramebuffer(i.DRAW_FRAMEBUFFER,[v])}}}function be(C){return Math.min(s.maxSamples,C.samples)}function gt(C){let v=n.get(C);return C.samples>0&&t.has("WEBGL_multisampled_render_to_texture")===!0&&v.__useRenderToTexture!==!1}function Le(C){let v=o.render.frame;h.get(C)!==v&&(h.set(C,v),C.update())}function Gt(C,v){let B=C.colorSpace,it=C.format,K=C.type;return C.isCompressedTexture===!0||C.isVideoTexture===!0||B!==ns&&B!==Si&&(se.getTransfer(B)===_e?(it!==Sn||K!==Mn)&&Vt("WebGLTextures: sRGB encoded textures have to use RGBAFormat and UnsignedByteType."):Wt("WebGLTextures: Unsupported texture color space:",B)),v}function qt(C){return typeof HTMLImageElement<"u"&&C instanceof HTMLImageElement?(c.width=C.naturalWidth||C.width,c.height=C.naturalHeight||C.height):typeof VideoFrame<"u"&&C instanceof VideoFrame?(c.width=C.displayWidth,c.height=C.displayHeight):(c.width=C.width,c.height=C.height),c}this.allocateTextureUnit=Nt,this.resetTextureUnits=Q,this.getTextureUnits=et,this.setTextureUnits=Et,this.setTexture2D=ht,this.setTexture2DArray=At,this.setTexture3D=Ot,this.setTextureCube=vt,this.rebindTextures=oe,this.setupRenderTarget=de,this.updateRenderTargetMipmap=N,this.updateMultisampleRenderTarget=ie,this.setupDepthRenderbuffer=re,this.setupFrameBufferTexture=yt,this.useMultisampledRTT=gt,this.dispose=V}function mM(i,t){function e(n,s=Si){let r,o=se.getTransfer(s);if(n===Mn)return i.UNSIGNED_BYTE;if(n===cl)return i.UNSIGNED_SHORT_4_4_4_4;if(n===hl)return i.UNSIGNED_SHORT_5_5_5_1;if(n===$h)return i.UNSIGNED_INT_5_9_9_9_REV;if(n===Yh)return i.UNSIGNED_INT_10F_11F_11F_REV;if(n===Xh)return i.BYTE;if(n===qh)return i.SHORT;if(n===Js)return i.UNSIGNED_SHORT;if(n===ll)return i.INT;if(n===kn)return i.UNSIGNED_INT;if(n===fn)return i.FLOAT;if(n===zn)return i.HALF_FLOAT;if(n===Zh)return i.ALPHA;if(n===Jh)return i.RGB;if(n===Sn)return i.RGBA;if(n===gi)return i.DEPTH_COMPONENT;if(n===Mi)return i.DEPTH_STENCIL;if(n===ul)return i.RED;if(n===dl)return i.RED_INTEGER;if(n===Wi)return i.RG;if(n===fl)return i.RG_INTEGER;if(n===pl)return i.RGBA_INTEGER;if(n===io||n===so||n===ro||n===oo)if(o===_e)if(r=t.get("WEBGL_compressed_texture_s3tc_srgb"),r!==null){if(n===io)return r.COMPRESSED_SRGB_S3TC_DXT1_EXT;if(n===so)return r.COMPRESSED_SRGB_ALPHA_S3TC_DXT1_EXT;if(n===ro)return r.COMPRESSED_SRGB_ALPHA_S3TC_DXT3_EXT;if(n===oo)return r.COMPRESSED_SRGB_ALPHA_S3TC_DXT5_EXT}else return null;else if(r=t.get("WEBGL_compressed_texture_s3tc"),r!==null){if(n===io)return r.COMPRESSED_RGB_S3TC_DXT1_EXT;if(n===so)return r.COMPRESSED_RGBA_S3TC_DXT1_EXT;if(n===ro)return r.COMPRESSED_RGBA_S3TC_DXT3_EXT;if(n===oo)return r.COMPRESSED_RGBA_S3TC_DXT5_EXT}else return null;if(n===ml||n===gl||n===_l||n===xl)if(r=t.get("WEBGL_compressed_texture_pvrtc"),r!==null){if(n===ml)return r.COMPRESSED_RGB_PVRTC_4BPPV1_IMG;if(n===gl)return r.COMPRESSED_RGB_PVRTC_2BPPV1_IMG;if(n===_l)return r.COMPRESSED_RGBA_PVRTC_4BPPV1_IMG;if(n===xl)return r.COMPRESSED_RGBA_PVRTC_2BPPV1_IMG}else return null;if(n===vl||n===yl||n===bl||n===Ml||n===Sl||n===ao||n===wl)if(r=t.get("WEBGL_compressed_texture_etc"),r!==null){if(n===vl||n===yl)return o===_e?r.COMPRESSED_SRGB8_ETC2:r.COMPRESSED_RGB8_ETC2;if(n===bl)return o===_e?r.COMPRESSED_SRGB8_ALPHA8_ETC2_EAC:r.COMPRESSED_RGBA8_ETC2_EAC;if(n===Ml)return r.COMPRESSED_R11_EAC;if(n===Sl)return r.COMPRESSED_SIGNED_R11_EAC;if(n===ao)return r.COMPRESSED_RG11_EAC;if(n===wl)return r.COMPRESSED_SIGNED_RG11_EAC}else return null;if(n===El||n===Al||n===Tl||n===Cl||n===Rl||n===Pl||n===Il||n===Ll||n===Dl||n===Nl||n===Ul||n===Ol||n===Fl||n===Bl)if(r=t.get("WEBGL_compressed_texture_astc"),r!==null){if(n===El)return o===_e?r.COMPRESSED_SRGB8_ALPHA8_ASTC_4x4_KHR:r.COMPRESSED_RGBA_ASTC_4x4_KHR;if(n===Al)return o===_e?r.COMPRESSED_SRGB8_ALPHA8_ASTC_5x4_KHR:r.COMPRESSED_RGBA_ASTC_5x4_KHR;if(n===Tl)return o===_e?r.COMPRESSED_SRGB8_ALPHA8_ASTC_5x5_KHR:r.COMPRESSED_RGBA_ASTC_5x5_KHR;if(n===Cl)return o===_e?r.COMPRESSED_SRGB8_ALPHA8_ASTC_6x5_KHR:r.COMPRESSED_RGBA_ASTC_6x5_KHR;if(n===Rl)return o===_e?r.COMPRESSED_SRGB8_ALPHA8_ASTC_6x6_KHR:r.COMPRESSED_RGBA_ASTC_6x6_KHR;if(n===Pl)return o===_e?r.COMPRESSED_SRGB8_ALPHA8_ASTC_8x5_KHR:r.COMPRESSED_RGBA_ASTC_8x5_KHR;if(n===Il)return o===_e?r.COMPRESSED_SRGB8_ALPHA8_ASTC_8x6_KHR:r.COMPRESSED_RGBA_ASTC_8x6_KHR;if(n===Ll)return o===_e?r.COMPRESSED_SRGB8_ALPHA8_ASTC_8x8_KHR:r.COMPRESSED_RGBA_ASTC_8x8_KHR;if(n===Dl)return o===_e?r.COMPRESSED_SRGB8_ALPHA8_ASTC_10x5_KHR:r.COMPRESSED_RGBA_ASTC_10x5_KHR;if(n===Nl)return o===_e?r.COMPRESSED_SRGB8_ALPHA8_ASTC_10x6_KHR:r.COMPRESSED_RGBA_ASTC_10x6_KHR;if(n===Ul)return o===_e?r.COMPRESSED_SRGB8_ALPHA8_ASTC_10x8_KHR:r.COMPRESSED_RGBA_ASTC_10x8_KHR;if(n===Ol)return o===_e?r.COMPRESSED_SRGB8_ALPHA8_ASTC_10x10_KHR:r.COMPRESSED_RGBA_ASTC_10x10_KHR;if(n===Fl)return o===_e?r.COMPRESSED_SRGB8_ALPHA8_ASTC_12x10_KHR:r.COMPRESSED_RGBA_ASTC_12x10_KHR;if(n===Bl)return o===_e?r.COMPRESSED_SRGB8_ALPHA8_ASTC_12x12_KHR:r.COMPRESSED_RGBA_ASTC_12x12_KHR}else return null;if(n===kl||n===zl||n===Gl)if(r=t.get("EXT_texture_compression_bptc"),r!==null){if(n===kl)return o===_e?r.COMPRESSED_SRGB_ALPHA_BPTC_UNORM_EXT:r.COMPRESSED_RGBA_BPTC_UNORM_EXT;if(n===zl)return r.COMPRESSED_RGB_BPTC_SIGNED_FLOAT_EXT;if(n===Gl)return r.COMPRESSED_RGB_BPTC_UNSIGNED_FLOAT_EXT}else return null;if(n===Vl||n===Hl||n===lo||n===Wl)if(r=t.get("EXT_texture_compression_rgtc"),r!==null){if(n===Vl)return r.COMPRESSED_RED_RGTC1_EXT;if(n===Hl)return r.COMPRESSED_SIGNED_RED_RGTC1_EXT;if(n===lo)return r.COMPRESSED_RED_GREEN_RGTC2_EXT;if(n===Wl)return r.COMPRESSED_SIGNED_RED_GREEN_RGTC2_EXT}else return null;return n===hs?i.UNSIGNED_INT_24_8:i[n]!==void 0?i[n]:null}return{convert:e}}var gM=`
void main() {

	gl_Position = vec4( position, 1.0 );

}`,_M=`
uniform sampler2DArray depthColor;
uniform float depthWidth;
uniform float depthHeight;

void main() {

	vec2 coord = vec2( gl_FragCoord.x / depthWidth, gl_FragCoord.y / depthHeight );

	if ( coord.x >= 1.0 ) {

		gl_FragDepth = texture( depthColor, vec3( coord.x - 1.0, coord.y, 1 ) ).r;

	} else {

		gl_FragDepth = texture( depthColor, vec3( coord.x, coord.y, 0 ) ).r;

	}

}`,Mu=class{constructor(){this.texture=null,this.mesh=null,this.depthNear=0,this.depthFar=0}init(t,e){if(this.texture===null){let n=new Br(t.texture);(t.depthNear!==e.depthNear||t.depthFar!==e.depthFar)&&(this.depthNear=t.depthNear,this.depthFar=t.depthFar),this.texture=n}}getMesh(t){if(this.texture!==null&&this.mesh===null){let e=t.cameras[0].viewport,n=new Je({vertexShader:gM,fragmentShader:_M,uniforms:{depthColor:{value:this.texture},depthWidth:{value:e.z},depthHeight:{value:e.w}}});this.mesh=new Ee(new Bi(20,20),n)}return this.mesh}reset(){this.texture=null,this.mesh=null}getDepthTexture(){return this.texture}},Su=class extends Bn{constructor(t,e){super();let n=this,s=null,r=1,o=null,a="local-floor",l=1,c=null,h=null,u=null,d=null,f=null,m=null,x=typeof XRWebGLBinding<"u",p=new Mu,g={},y=e.getContextAttributes(),w=null,S=null,T=[],A=[],_=new rt,E=null,O=null,P=new sn;P.viewport=new Te;let U=new sn;U.viewport=new Te;let G=[P,U],$=new nl,L=null,V=null;this.cameraAutoUpdate=!0,this.enabled=!1,this.isPresenting=!1,this.getController=function(Y){let ht=T[Y];return ht===void 0&&(ht=new zs,T[Y]=ht),ht.getTargetRaySpace()},this.getControllerGrip=function(Y){let ht=T[Y];return ht===void 0&&(ht=new zs,T[Y]=ht),ht.getGripSpace()},this.getHand=function(Y){let ht=T[Y];return ht===void 0&&(ht=new zs,T[Y]=ht),ht.getHandSpace()};function X(Y){let ht=A.indexOf(Y.inputSource);if(ht===-1)return;let At=T[ht];At!==void 0&&(At.update(Y.inputSource,Y.frame,c||o),At.dispatchEvent({type:Y.type,data:Y.inputSource}))}function z(){s.removeEventListener("select",X),s.removeEventListener("selectstart",X),s.removeEventListener("selectend",X),s.removeEventListener("squeeze",X),s.removeEventListener("squeezestart",X),s.removeEventListener("squeezeend",X),s.removeEventListener("end",z),s.removeEventListener("inputsourceschange",nt);for(let Y=0;Y<T.length;Y++){let ht=A[Y];ht!==null&&(A[Y]=null,T[Y].disconnect(ht))}L=null,V=null,p.reset();for(let Y in g)delete g[Y];if(t.setRenderTarget(w),f=null,d=null,u=null,s=null,S=null,Nt.stop(),n.isPresenting=!1,t.setPixelRatio(E),t.setSize(_.width,_.height,!1),O!==null){let Y=O.camera;Y.fov=O.fov,Y.zoom=O.zoom,Y.updateProjectionMatrix(),O=null}n.dispatchEvent({type:"sessionend"})}this.setFramebufferScaleFactor=function(Y){r=Y,n.isPresenting===!0&&Vt("WebXRManager: Cannot change framebuffer scale while presenting.")},this.setReferenceSpaceType=function(Y){a=Y,n.isPresenting===!0&&Vt("WebXRManager: Cannot change reference space type while presenting.")},this.getReferenceSpace=function(){return c||o},this.setReferenceSpace=function(Y){c=Y},this.getBaseLayer=function(){return d!==null?d:f},this.getBinding=function(){return u===null&&x&&(u=new XRWebGLBinding(s,e)),u},this.getFrame=function(){return m},this.getSession=function(){return s},this.setSession=async function(Y){if(s=Y,s!==null){if(w=t.getRenderTarget(),s.addEventListener("select",X),s.addEventListener("selectstart",X),s.addEventListener("selectend",X),s.addEventListener("squeeze",X),s.addEventListener("squeezestart",X),s.addEventListener("squeezeend",X),s.addEventListener("end",z),s.addEventListener("inputsourceschange",nt),y.xrCompatible!==!0&&await e.makeXRCompatible(),E=t.getPixelRatio(),t.getSize(_),x&&"createProjectionLayer"in XRWebGLBinding.prototype){let At=null,Ot=null,vt=null;y.depth&&(vt=y.stencil?e.DEPTH24_STENCIL8:e.DEPTH_COMPONENT24,At=y.stencil?Mi:gi,Ot=y.stencil?hs:kn);let Bt={colorFormat:e.RGBA8,depthFormat:vt,scaleFactor:r};u=this.getBinding(),d=u.createProjectionLayer(Bt),s.updateRenderState({layers:[d]}),t.setPixelRatio(1),t.setSize(d.textureWidth,d.textureHeight,!1),S=new Ze(d.textureWidth,d.textureHeight,{format:Sn,type:Mn,depthTexture:new yi(d.textureWidth,d.textureHeight,Ot,void 0,void 0,void 0,void 0,void 0,void 0,At),stencilBuffer:y.stencil,colorSpace:t.outputColorSpace,samples:y.antialias?4:0,resolveDepthBuffer:d.ignoreDepthValues===!1,resolveStencilBuffer:d.ignoreDepthValues===!1,storeMultisampledDepthBuffer:d.ignoreDepthValues===!1,storeMultisampledStencilBuffer:d.ignoreDepthValues===!1})}else{let At={antialias:y.antialias,alpha:!0,depth:y.depth,stencil:y.stencil,framebufferScaleFactor:r};f=new XRWebGLLayer(s,e,At),s.updateRenderState({baseLayer:f}),t.setPixelRatio(1),t.setSize(f.framebufferWidth,f.framebufferHeight,!1),S=new Ze(f.framebufferWidth,f.framebufferHeight,{format:Sn,type:Mn,colorSpace:t.outputColorSpace,stencilBuffer:y.stencil,resolveDepthBuffer:f.ignoreDepthValues===!1,resolveStencilBuffer:f.ignoreDepthValues===!1,storeMultisampledDepthBuffer:f.ignoreDepthValues===!1,storeMultisampledStencilBuffer:f.ignoreDepthValues===!1})}S.isXRRenderTarget=!0,this.setFoveation(l),c=null,o=await s.requestReferenceSpace(a),Nt.setContext(s),Nt.start(),n.isPresenting=!0,n.dispatchEvent({type:"sessionstart"})}},this.getEnvironmentBlendMode=function(){if(s!==null)return s.environmentBlendMode},this.getDepthTexture=function(){return p.getDepthTexture()};function nt(Y){for(let ht=0;ht<Y.removed.length;ht++){let At=Y.removed[ht],Ot=A.indexOf(At);Ot>=0&&(A[Ot]=null,T[Ot].disconnect(At))}for(let ht=0;ht<Y.added.length;ht++){let At=Y.added[ht],Ot=A.indexOf(At);if(Ot===-1){for(let Bt=0;Bt<T.length;Bt++)if(Bt>=A.length){A.push(At),Ot=Bt;break}else if(A[Bt]===null){A[Bt]=At,Ot=Bt;break}if(Ot===-1)break}let vt=T[Ot];vt&&vt.connect(At)}}function H(Y,ht){ht===null?Y.matrixWorld.copy(Y.matrix):Y.matrixWorld.multiplyMatrices(ht.matrixWorld,Y.matrix),Y.matrixWorldInverse.copy(Y.matrixWorld).invert()}this.updateCamera=function(Y){if(s===null)return;let ht=Y.near,At=Y.far;p.texture!==null&&(p.depthNear>0&&(ht=p.depthNear),p.depthFar>0&&(At=p.depthFar)),$.near=U.near=P.near=ht,$.far=U.far=P.far=At,(L!==$.near||V!==$.far)&&(s.updateRenderState({depthNear:$.near,depthFar:$.far}),L=$.near,V=$.far),$.layers.mask=Y.layers.mask|6,P.layers.mask=$.layers.mask&-5,U.layers.mask=$.layers.mask&-3;let Ot=Y.parent,vt=$.cameras;H($,Ot);for(let Bt=0;Bt<vt.length;Bt++)H(vt[Bt],Ot);$.projectionMatrix.copy(P.projectionMatrix),$.projectionMatrixInverse.copy(P.projectionMatrixInverse),O===null&&Y.isPerspectiveCamera&&(O={camera:Y,fov:Y.fov,zoom:Y.zoom}),Q(Y,$,Ot)};function Q(Y,ht,At){At===null?Y.matrix.copy(ht.matrixWorld):(Y.matrix.copy(At.matrixWorld),Y.matrix.invert(),Y.matrix.multiply(ht.matrixWorld)),Y.matrix.decompose(Y.position,Y.quaternion,Y.scale),Y.updateMatrixWorld(!0),Y.projectionMatrix.copy(ht.projectionMatrix),Y.projectionMatrixInverse.copy(ht.projectionMatrixInverse),Y.isPerspectiveCamera&&(Y.fov=Fs*2*Math.atan(1/Y.projectionMatrix.elements[5]),Y.zoom=1)}this.getCamera=function(){return $},this.getFoveation=function(){if(!(d===null&&f===null))return l},this.setFoveation=function(Y){l=Y,d!==null&&(d.fixedFoveation=Y),f!==null&&f.fixedFoveation!==void 0&&(f.fixedFoveation=Y)},this.hasDepthSensing=function(){return p.texture!==null},this.getDepthSensingMesh=function(){return p.getMesh($)},this.getCameraTexture=function(Y){return g[Y]};let et=null;function Et(Y,ht){if(h=ht.getViewerPose(c||o),m=ht,h!==null){let At=h.views;f!==null&&(t.setRenderTargetFramebuffer(S,f.framebuffer),t.setRenderTarget(S));let Ot=!1;At.length!==$.cameras.length&&($.cameras.length=0,Ot=!0);for(let kt=0;kt<At.length;kt++){let jt=At[kt],Qt=null;if(f!==null)Qt=f.getViewport(jt);else{let ut=u.getViewSubImage(d,jt);Qt=ut.viewport,kt===0&&(t.setRenderTargetTextures(S,ut.colorTexture,ut.depthStencilTexture),t.setRenderTarget(S))}let tt=G[kt];tt===void 0&&(tt=new sn,tt.layers.enable(kt),tt.viewport=new Te,G[kt]=tt),tt.matrix.fromArray(jt.transform.matrix),tt.matrix.decompose(tt.position,tt.quaternion,tt.scale),tt.projectionMatrix.fromArray(jt.projectionMatrix),tt.projectionMatrixInverse.copy(tt.projectionMatrix).invert(),tt.viewport.set(Qt.x,Qt.y,Qt.width,Qt.height),kt===0&&($.matrix.copy(tt.matrix),$.matrix.decompose($.position,$.quaternion,$.scale)),Ot===!0&&$.cameras.push(tt)}let vt=s.enabledFeatures;if(vt&&vt.includes("depth-sensing")&&s.depthUsage=="gpu-optimized"&&x){u=n.getBinding();let kt=u.getDepthInformation(At[0]);kt&&kt.isValid&&kt.texture&&p.init(kt,s.renderState)}if(vt&&vt.includes("camera-access")&&x){t.state.unbindTexture(),u=n.getBinding();for(let kt=0;kt<At.length;kt++){let jt=At[kt].camera;if(jt){let Qt=g[jt];Qt||(Qt=new Br,g[jt]=Qt);let tt=u.getCameraImage(jt);Qt.sourceTexture=tt}}}}for(let At=0;At<T.length;At++){let Ot=A[At],vt=T[At];Ot!==null&&vt!==void 0&&vt.update(Ot,ht,c||o)}et&&et(Y,ht),ht.detectedPlanes&&n.dispatchEvent({type:"planesdetected",data:ht}),m=null}let Nt=new Vp;Nt.setAnimationLoop(Et),this.setAnimationLoop=function(Y){et=Y},this.dispose=function(){}}},xM=new ue,Kp=new $t;Kp.set(-1,0,0,0,1,0,0,0,1);function vM(i,t){function e(p,g){p.matrixAutoUpdate===!0&&p.updateMatrix(),g.value.copy(p.matrix)}function n(p,g){g.color.getRGB(p.fogColor.value,hu(i)),g.isFog?(p.fogNear.value=g.near,p.fogFar.value=g.far):g.isFogExp2&&(p.fogDensity.value=g.density)}function s(p,g,y,w,S){g.isNodeMaterial?g.uniformsNeedUpdate=!1:g.isMeshBasicMaterial?r(p,g):g.isMeshLambertMaterial?(r(p,g),g.envMap&&(p.envMapIntensity.value=g.envMapIntensity)):g.isMeshToonMaterial?(r(p,g),u(p,g)):g.isMeshPhongMaterial?(r(p,g),h(p,g),g.envMap&&(p.envMapIntensity.value=g.envMapIntensity)):g.isMeshStandardMaterial?(r(p,g),d(p,g),g.isMeshPhysicalMaterial&&f(p,g,S)):g.isMeshMatcapMaterial?(r(p,g),m(p,g)):g.isMeshDepthMaterial?r(p,g):g.isMeshDistanceMaterial?(r(p,g),x(p,g)):g.isMeshNormalMaterial?r(p,g):g.isLineBasicMaterial?(o(p,g),g.isLineDashedMaterial&&a(p,g)):g.isPointsMaterial?l(p,g,y,w):g.isSpriteMaterial?c(p,g):g.isShadowMaterial?(p.color.value.copy(g.color),p.opacity.value=g.opacity):g.isShaderMaterial&&(g.uniformsNeedUpdate=!1)}function r(p,g){p.opacity.value=g.opacity,g.color&&p.diffuse.value.copy(g.color),g.emissive&&p.emissive.value.copy(g.emissive).multiplyScalar(g.emissiveIntensity),g.map&&(p.map.value=g.map,e(g.map,p.mapTransform)),g.alphaMap&&(p.alphaMap.value=g.alphaMap,e(g.alphaMap,p.alphaMapTransform)),g.bumpMap&&(p.bumpMap.value=g.bumpMap,e(g.bumpMap,p.bumpMapTransform),p.bumpScale.value=g.bumpScale,g.side===Ge&&(p.bumpScale.value*=-1)),g.normalMap&&(p.normalMap.value=g.normalMap,e(g.normalMap,p.normalMapTransform),p.normalScale.value.copy(g.normalScale),g.side===Ge&&p.normalScale.value.negate()),g.displacementMap&&(p.displacementMap.value=g.displacementMap,e(g.displacementMap,p.displacementMapTransform),p.displacementScale.value=g.displacementScale,p.displacementBias.value=g.displacementBias),g.emissiveMap&&(p.emissiveMap.value=g.emissiveMap,e(g.emissiveMap,p.emissiveMapTransform)),g.specularMap&&(p.specularMap.value=g.specularMap,e(g.specularMap,p.specularMapTransform)),g.alphaTest>0&&(p.alphaTest.value=g.alphaTest);let y=t.get(g),w=y.envMap,S=y.envMapRotation;w&&(p.envMap.value=w,p.envMapRotation.value.setFromMatrix4(xM.makeRotationFromEuler(S)).transpose(),w.isCubeTexture&&w.isRenderTargetTexture===!1&&p.envMapRotation.value.premultiply(Kp),p.reflectivity.value=g.reflectivity,p.ior.value=g.ior,p.refractionRatio.value=g.refractionRatio),g.lightMap&&(p.lightMap.value=g.lightMap,p.lightMapIntensity.value=g.lightMapIntensity,e(g.lightMap,p.lightMapTransform)),g.aoMap&&(p.aoMap.value=g.aoMap,p.aoMapIntensity.value=g.aoMapIntensity,e(g.aoMap,p.aoMapTransform))}function o(p,g){p.diffuse.value.copy(g.color),p.opacity.value=g.opacity,g.map&&(p.map.value=g.map,e(g.map,p.mapTransform))}function a(p,g){p.dashSize.value=g.dashSize,p.totalSize.value=g.dashSize+g.gapSize,p.scale.value=g.scale}function l(p,g,y,w){p.diffuse.value.copy(g.color),p.opacity.value=g.opacity,p.size.value=g.size*y,p.scale.value=w*.5,g.map&&(p.map.value=g.map,e(g.map,p.uvTransform)),g.alphaMap&&(p.alphaMap.value=g.alphaMap,e(g.alphaMap,p.alphaMapTransform)),g.alphaTest>0&&(p.alphaTest.value=g.alphaTest)}function c(p,g){p.diffuse.value.copy(g.color),p.opacity.value=g.opacity,p.rotation.value=g.rotation,g.map&&(p.map.value=g.map,e(g.map,p.mapTransform)),g.alphaMap&&(p.alphaMap.value=g.alphaMap,e(g.alphaMap,p.alphaMapTransform)),g.alphaTest>0&&(p.alphaTest.value=g.alphaTest)}function h(p,g){p.specular.value.copy(g.specular),p.shininess.value=Math.max(g.shininess,1e-4)}function u(p,g){g.gradientMap&&(p.gradientMap.value=g.gradientMap)}function d(p,g){p.metalness.value=g.metalness,g.metalnessMap&&(p.metalnessMap.value=g.metalnessMap,e(g.metalnessMap,p.metalnessMapTransform)),p.roughness.value=g.roughness,g.roughnessMap&&(p.roughnessMap.value=g.roughnessMap,e(g.roughnessMap,p.roughnessMapTransform)),g.envMap&&(p.envMapIntensity.value=g.envMapIntensity)}function f(p,g,y){p.ior.value=g.ior,g.diffuseRoughness>0&&(p.diffuseRoughness.value=g.diffuseRoughness,g.diffuseRoughnessMap&&(p.diffuseRoughnessMap.value=g.diffuseRoughnessMap,e(g.diffuseRoughnessMap,p.diffuseRoughnessMapTransform))),g.sheen>0&&(p.sheenColor.value.copy(g.sheenColor).multiplyScalar(g.sheen),p.sheenRoughness.value=g.sheenRoughness,g.sheenColorMap&&(p.sheenColorMap.value=g.sheenColorMap,e(g.sheenColorMap,p.sheenColorMapTransform)),g.sheenRoughnessMap&&(p.sheenRoughnessMap.value=g.sheenRoughnessMap,e(g.sheenRoughnessMap,p.sheenRoughnessMapTransform))),g.clearcoat>0&&(p.clearcoat.value=g.clearcoat,p.clearcoatRoughness.value=g.clearcoatRoughness,g.clearcoatMap&&(p.clearcoatMap.value=g.clearcoatMap,e(g.clearcoatMap,p.clearcoatMapTransform)),g.clearcoatRoughnessMap&&(p.clearcoatRoughnessMap.value=g.clearcoatRoughnessMap,e(g.clearcoatRoughnessMap,p.clearcoatRoughnessMapTransform)),g.clearcoatNormalMap&&(p.clearcoatNormalMap.value=g.clearcoatNormalMap,e(g.clearcoatNormalMap,p.clearcoatNormalMapTransform),p.clearcoatNormalScale.value.copy(g.clearcoatNormalScale),g.side===Ge&&p.clearcoatNormalScale.value.negate())),g.dispersion>0&&(p.dispersion.value=g.dispersion),g.retroreflectivity>0&&(p.retroreflectivity.value=g.retroreflectivity),g.iridescence>0&&(p.iridescence.value=g.iridescence,p.iridescenceIOR.value=g.iridescenceIOR,p.iridescenceThicknessMinimum.value=g.iridescenceThicknessMinimum,p.iridescenceThicknessMaximum.value=g.iridescenceThicknessMaximum,g.iridescenceMap&&(p.iridescenceMap.value=g.iridescenceMap,e(g.iridescenceMap,p.iridescenceMapTransform)),g.iridescenceThicknessMap&&(p.iridescenceThicknessMap.value=g.iridescenceThicknessMap,e(g.iridescenceThicknessMap,p.iridescenceThicknessMapTransform))),g.transmission>0&&(p.transmission.value=g.transmission,p.transmissionSamplerMap.value=y.texture,p.transmissionSamplerSize.value.set(y.width,y.height),g.transmissionMap&&(p.transmissionMap.value=g.transmissionMap,e(g.transmissionMap,p.transmissionMapTransform)),p.thickness.value=g.thickness,g.thicknessMap&&(p.thicknessMap.value=g.thicknessMap,e(g.thicknessMap,p.thicknessMapTransform)),p.attenuationDistance.value=g.attenuationDistance,p.attenuationColor.value.copy(g.attenuationColor)),g.anisotropy>0&&(p.anisotropyVector.value.set(g.anisotropy*Math.cos(g.anisotropyRotation),g.anisotropy*Math.sin(g.anisotropyRotation)),g.anisotropyMap&&(p.anisotropyMap.value=g.anisotropyMap,e(g.anisotropyMap,p.anisotropyMapTransform))),p.specularIntensity.value=g.specularIntensity,p.specularColor.value.copy(g.specularColor),g.specularColorMap&&(p.specularColorMap.value=g.specularColorMap,e(g.specularColorMap,p.specularColorMapTransform)),g.specularIntensityMap&&(p.specularIntensityMap.value=g.specularIntensityMap,e(g.specularIntensityMap,p.specularIntensityMapTransform))}function m(p,g){g.matcap&&(p.matcap.value=g.matcap)}function x(p,g){let y=t.get(g).light;p.referencePosition.value.setFromMatrixPosition(y.matrixWorld),p.nearDistance.value=y.shadow.camera.near,p.farDistance.value=y.shadow.camera.far}return{refreshFogUniforms:n,refreshMaterialUniforms:s}}function yM(i,t,e,n){let s={},r={};function o(y,w){let S=w.program;n.uniformBlockBinding(y,S,s[y.id])}function a(y,w){let S=s[y.id];S===void 0&&(m(y),S=l(y),s[y.id]=S,y.addEventListener("dispose",p));let T=w.program;n.updateUBOMapping(y,T);let A=t.render.frame;r[y.id]!==A&&(c(y),r[y.id]=A)}function l(y){let w=i.createBuffer(),S=y.__size,T=y.usage;return i.bindBuffer(i.UNIFORM_BUFFER,w),i.bufferData(i.UNIFORM_BUFFER,S,T),i.bindBuffer(i.UNIFORM_BUFFER,null),w}function c(y){let w=s[y.id],S=y.uniforms,T=y.__cache;i.bindBuffer(i.UNIFORM_BUFFER,w);for(let A=0,_=S.length;A<_;A++){let E=S[A];if(Array.isArray(E))for(let O=0,P=E.length;O<P;O++)h(E[O],A,O,T);else h(E,A,0,T)}i.bindBuffer(i.UNIFORM_BUFFER,null)}function h(y,w,S,T){if(d(y,w,S,T)===!0){let A=y.__offset,_=y.value;if(Array.isArray(_)){let E=0;for(let O=0;O<_.length;O++){let P=_[O],U=x(P,!0);u(P,y.__data,E),E+=U.storage/Float32Array.BYTES_PER_ELEMENT}}else u(_,y.__data,0);i.bufferSubData(i.UNIFORM_BUFFER,A,y.__data)}}function u(y,w,S){typeof y=="number"||typeof y=="boolean"?w[S]=y:y.isMatrix3?(w[S]=y.elements[0],w[S+1]=y.elements[1],w[S+2]=y.elements[2],w[S+3]=0,w[S+4]=y.elements[3],w[S+5]=y.elements[4],w[S+6]=y.elements[5],w[S+7]=0,w[S+8]=y.elements[6],w[S+9]=y.elements[7],w[S+10]=y.elements[8],w[S+11]=0):ArrayBuffer.isView(y)?w.set(y.subarray(0,w.length-S),S):y.toArray(w,S)}function d(y,w,S,T){let A=y.value,_=w+"_"+S;if(Array.isArray(A)){T[_]===void 0&&(T[_]=[]);let E=T[_],O=!1;for(let P=0;P<A.length;P++)f(A[P],E,P)===!0&&(O=!0);return O}return f(A,T,_)}function f(y,w,S){if(w[S]===void 0)return typeof y=="number"||typeof y=="boolean"?w[S]=y:ArrayBuffer.isView(y)?w[S]=y.slice():w[S]=y.clone(),!0;{let T=w[S];if(typeof y=="number"||typeof y=="boolean"){if(T!==y)return w[S]=y,!0}else{if(ArrayBuffer.isView(y))return!0;if(T.equals(y)===!1)return T.copy(y),!0}}return!1}function m(y){let w=y.uniforms,S=0,T=16;for(let _=0,E=w.length;_<E;_++){let O=Array.isArray(w[_])?w[_]:[w[_]];for(let P=0,U=O.length;P<U;P++){let G=O[P],$=Array.isArray(G.value)?G.value:[G.value],L=Array.isArray(w[_])||Array.isArray(G.value),V=S;for(let z=0,nt=$.length;z<nt;z++){let H=$[z],Q=x(H,L),et=S%T,Et=et%Q.boundary,Nt=et+Et;S+=Et,Nt!==0&&T-Nt<Q.storage&&(S+=T-Nt),z===0&&(V=S),S+=Q.storage}let X=G.type==="int"?Int32Array:G.type==="uint"?Uint32Array:Float32Array;G.__data=new X((S-V)/Float32Array.BYTES_PER_ELEMENT),G.__offset=V}}let A=S%T;return A>0&&(S+=T-A),y.__size=S,y.__cache={},this}function x(y,w){let S={boundary:0,storage:0};return typeof y=="number"||typeof y=="boolean"?(S.boundary=4,S.storage=4):y.isVector2?(S.boundary=8,S.storage=8):y.isVector3||y.isColor?(S.boundary=16,S.storage=12):y.isVector4?(S.boundary=16,S.storage=16):y.isMatrix3?(S.boundary=16,S.storage=48):y.isMatrix4?(S.boundary=16,S.storage=64):y.isTexture?Vt("WebGLRenderer: Texture samplers can not be part of an uniforms group."):ArrayBuffer.isView(y)?(S.boundary=16,S.storage=y.byteLength):Vt("WebGLRenderer: Unsupported uniform value type.",y),w===!0&&(S.boundary=16,S.storage=Math.ceil(S.storage/16)*16),S}function p(y){let w=y.target;w.removeEventListener("dispose",p),i.deleteBuffer(s[w.id]),delete s[w.id],delete r[w.id]}function g(){for(let y in s)i.deleteBuffer(s[y]);s={},r={}}return{bind:o,update:a,dispose:g}}var bM=new Uint16Array([12469,15057,12620,14925,13266,14620,13807,14376,14323,13990,14545,13625,14713,13328,14840,12882,14931,12528,14996,12233,15039,11829,15066,11525,15080,11295,15085,10976,15082,10705,15073,10495,13880,14564,13898,14542,13977,14430,14158,14124,14393,13732,14556,13410,14702,12996,14814,12596,14891,12291,14937,11834,14957,11489,14958,11194,14943,10803,14921,10506,14893,10278,14858,9960,14484,14039,14487,14025,14499,13941,14524,13740,14574,13468,14654,13106,14743,12678,14818,12344,14867,11893,14889,11509,14893,11180,14881,10751,14852,10428,14812,10128,14765,9754,14712,9466,14764,13480,14764,13475,14766,13440,14766,13347,14769,13070,14786,12713,14816,12387,14844,11957,14860,11549,14868,11215,14855,10751,14825,10403,14782,10044,14729,9651,14666,9352,14599,9029,14967,12835,14966,12831,14963,12804,14954,12723,14936,12564,14917,12347,14900,11958,14886,11569,14878,11247,14859,10765,14828,10401,14784,10011,14727,9600,14660,9289,14586,8893,14508,8533,15111,12234,15110,12234,15104,12216,15092,12156,15067,12010,15028,11776,14981,11500,14942,11205,14902,10752,14861,10393,14812,9991,14752,9570,14682,9252,14603,8808,14519,8445,14431,8145,15209,11449,15208,11451,15202,11451,15190,11438,15163,11384,15117,11274,15055,10979,14994,10648,14932,10343,14871,9936,14803,9532,14729,9218,14645,8742,14556,8381,14461,8020,14365,7603,15273,10603,15272,10607,15267,10619,15256,10631,15231,10614,15182,10535,15118,10389,15042,10167,14963,9787,14883,9447,14800,9115,14710,8665,14615,8318,14514,7911,14411,7507,14279,7198,15314,9675,15313,9683,15309,9712,15298,9759,15277,9797,15229,9773,15166,9668,15084,9487,14995,9274,14898,8910,14800,8539,14697,8234,14590,7790,14479,7409,14367,7067,14178,6621,15337,8619,15337,8631,15333,8677,15325,8769,15305,8871,15264,8940,15202,8909,15119,8775,15022,8565,14916,8328,14804,8009,14688,7614,14569,7287,14448,6888,14321,6483,14088,6171,15350,7402,15350,7419,15347,7480,15340,7613,15322,7804,15287,7973,15229,8057,15148,8012,15046,7846,14933,7611,14810,7357,14682,7069,14552,6656,14421,6316,14251,5948,14007,5528,15356,5942,15356,5977,15353,6119,15348,6294,15332,6551,15302,6824,15249,7044,15171,7122,15070,7050,14949,6861,14818,6611,14679,6349,14538,6067,14398,5651,14189,5311,13935,4958,15359,4123,15359,4153,15356,4296,15353,4646,15338,5160,15311,5508,15263,5829,15188,6042,15088,6094,14966,6001,14826,5796,14678,5543,14527,5287,14377,4985,14133,4586,13869,4257,15360,1563,15360,1642,15358,2076,15354,2636,15341,3350,15317,4019,15273,4429,15203,4732,15105,4911,14981,4932,14836,4818,14679,4621,14517,4386,14359,4156,14083,3795,13808,3437,15360,122,15360,137,15358,285,15355,636,15344,1274,15322,2177,15281,2765,15215,3223,15120,3451,14995,3569,14846,3567,14681,3466,14511,3305,14344,3121,14037,2800,13753,2467,15360,0,15360,1,15359,21,15355,89,15346,253,15325,479,15287,796,15225,1148,15133,1492,15008,1749,14856,1882,14685,1886,14506,1783,14324,1608,13996,1398,13702,1183]),ei=null;function MM(){return ei===null&&(ei=new is(bM,16,16,Wi,zn),ei.name="DFG_LUT",ei.minFilter=Ye,ei.magFilter=Ye,ei.wrapS=Yn,ei.wrapT=Yn,ei.generateMipmaps=!1,ei.needsUpdate=!0),ei}var Zl=class{constructor(t={}){let{canvas:e=ap(),context:n=null,depth:s=!0,stencil:r=!1,alpha:o=!1,antialias:a=!1,premultipliedAlpha:l=!0,preserveDrawingBuffer:c=!1,powerPreference:h="default",failIfMajorPerformanceCaveat:u=!1,reversedDepthBuffer:d=!1,outputBufferType:f=Mn}=t;this.isWebGLRenderer=!0;let m;if(n!==null){if(typeof WebGLRenderingContext<"u"&&n instanceof WebGLRenderingContext)throw new Error("THREE.WebGLRenderer: WebGL 1 is not supported since r163.");m=n.getContextAttributes().alpha}else m=o;let x=f,p=new Set([pl,fl,dl]),g=new Set([Mn,kn,Js,hs,cl,hl]),y=new Uint32Array(4),w=new Int32Array(4),S={textures:[],min:[],max:[],resolution:[]},T=null,A=null,_=[],E=[],O=null;this.domElement=e,this.debug={checkShaderErrors:!0,diagnostics:{keywords:!1},onShaderError:null},this.autoClear=!0,this.autoClearColor=!0,this.autoClearDepth=!0,this.autoClearStencil=!0,this.sortObjects=!0,this.clippingPlanes=[],this.localClippingEnabled=!1,this.toneMapping=ti,this.toneMappingExposure=1,this.transmissionResolutionScale=1;let P=this,U=!1,G=null,$=null,L=null,V=null;this._outputColorSpace=_n;let X=0,z=0,nt=null,H=-1,Q=null,et=new Te,Et=new Te,Nt=null,Y=new Yt(0),ht=0,At=e.width,Ot=e.height,vt=1,Bt=null,ye=null,kt=new Te(0,0,At,Ot),jt=new Te(0,0,At,Ot),Qt=!1,tt=new rs,ut=new La,at=!1,Tt=!1,yt=new ue,Jt=new I,Ut=new Te,re={background:null,fog:null,environment:null,overrideMaterial:null,isScene:!0},oe=!1;function de(){return nt===null?vt:1}let N=n;function Oe(M,D){return e.getContext(M,D)}let ie,be,gt,Le,Gt,qt,C,v,B,it,K,lt,_t,Z,J,dt,R,j,q,ft,ot,ct,Ft;try{let M={alpha:!0,depth:s,stencil:r,antialias:a,premultipliedAlpha:l,preserveDrawingBuffer:c,powerPreference:h,failIfMajorPerformanceCaveat:u};if("setAttribute"in e&&e.setAttribute("data-engine",`three.js r${"187"}`),e.addEventListener("webglcontextlost",zt,!1),e.addEventListener("webglcontextrestored",Kt,!1),e.addEventListener("webglcontextcreationerror",bt,!1),N===null){let D="webgl2";if(N=Oe(D,M),N===null)throw Oe(D)?new Error("THREE.WebGLRenderer: Error creating WebGL context with your selected attributes."):new Error("THREE.WebGLRenderer: Error creating WebGL context.")}te()}catch(M){throw e.removeEventListener("webglcontextlost",zt,!1),e.removeEventListener("webglcontextrestored",Kt,!1),e.removeEventListener("webglcontextcreationerror",bt,!1),Wt("WebGLRenderer: "+M.message),M}function te(){ie=new Dy(N),ie.init(),ot=new mM(N,ie),be=new My(N,ie,t,ot),gt=new fM(N,ie),be.reversedDepthBuffer&&d&&gt.buffers.depth.setReversed(!0),$=N.createFramebuffer(),L=N.createFramebuffer(),V=N.createFramebuffer(),Le=new Oy(N),Gt=new Qb,qt=new pM(N,ie,gt,Gt,be,ot,Le),C=new Ly(P),v=new B_(N),ct=new yy(N,v),B=new Ny(N,v,Le,ct),it=new By(N,B,v,ct,Le),j=new Fy(N,be,qt),J=new Sy(Gt),K=new Kb(P,C,ie,be,ct,J),lt=new vM(P,Gt),_t=new eM,Z=new aM(ie),R=new vy(P,C,gt,it,m,l),dt=new dM(P,it,be),Ft=new yM(N,Le,be,gt),q=new by(N,ie,Le),ft=new Uy(N,ie,Le),Le.programs=K.programs,P.capabilities=be,P.extensions=ie,P.properties=Gt,P.renderLists=_t,P.shadowMap=dt,P.state=gt,P.info=Le}x!==Mn&&(O=new zy(x,e.width,e.height,a,s,r));let st=new Su(P,N);this.xr=st,this.getContext=function(){return N},this.getContextAttributes=function(){return N.getContextAttributes()},this.forceContextLoss=function(){let M=ie.get("WEBGL_lose_context");M&&M.loseContext()},this.forceContextRestore=function(){let M=ie.get("WEBGL_lose_context");M&&M.restoreContext()},this.getPixelRatio=function(){return vt},this.setPixelRatio=function(M){M!==void 0&&(vt=M,this.setSize(At,Ot,!1))},this.getSize=function(M){return M.set(At,Ot)},this.setSize=function(M,D,W=!0){if(st.isPresenting){Vt("WebGLRenderer: Can't change size while VR device is presenting.");return}At=M,Ot=D,e.width=Math.floor(M*vt),e.height=Math.floor(D*vt),W===!0&&(e.style.width=M+"px",e.style.height=D+"px"),O!==null&&O.setSize(e.width,e.height),this.setViewport(0,0,M,D)},this.getDrawingBufferSize=function(M){return M.set(At*vt,Ot*vt).floor()},this.setDrawingBufferSize=function(M,D,W){At=M,Ot=D,vt=W,e.width=Math.floor(M*W),e.height=Math.floor(D*W),this.setViewport(0,0,M,D)},this.setEffects=function(M){if(x===Mn){Wt("WebGLRenderer: setEffects() requires outputBufferType set to HalfFloatType or FloatType.");return}if(M){for(let D=0;D<M.length;D++)if(M[D].isOutputPass===!0){Vt("WebGLRenderer: OutputPass is not needed in setEffects(). Tone mapping and color space conversion are applied automatically.");break}}O.setEffects(M||[])},this.getCurrentViewport=function(M){return M.copy(et)},this.getViewport=function(M){return M.copy(kt)},this.setViewport=function(M,D,W,F){M.isVector4?kt.set(M.x,M.y,M.z,M.w):kt.set(M,D,W,F),gt.viewport(et.copy(kt).multiplyScalar(de()).round())},this.getScissor=function(M){return M.copy(jt)},this.setScissor=function(M,D,W,F){M.isVector4?jt.set(M.x,M.y,M.z,M.w):jt.set(M,D,W,F),gt.scissor(Et.copy(jt).multiplyScalar(de()).round())},this.getScissorTest=function(){return Qt},this.setScissorTest=function(M){gt.setScissorTest(Qt=M)},this.setOpaqueSort=function(M){Bt=M},this.setTransparentSort=function(M){ye=M},this.getClearColor=function(M){return M.copy(R.getClearColor())},this.setClearColor=function(){R.setClearColor(...arguments)},this.getClearAlpha=function(){return R.getClearAlpha()},this.setClearAlpha=function(){R.setClearAlpha(...arguments)},this.clear=function(M=!0,D=!0,W=!0){let F=0;if(M){let k=!1;if(nt!==null){let xt=nt.texture.format;k=p.has(xt)}if(k){let xt=nt.texture.type,Rt=g.has(xt),pt=R.getClearColor(),St=R.getClearAlpha(),Dt=pt.r,Zt=pt.g,ae=pt.b;Rt?(y[0]=Dt,y[1]=Zt,y[2]=ae,y[3]=St,N.clearBufferuiv(N.COLOR,0,y)):(w[0]=Dt,w[1]=Zt,w[2]=ae,w[3]=St,N.clearBufferiv(N.COLOR,0,w))}else F|=N.COLOR_BUFFER_BIT}D&&(F|=N.DEPTH_BUFFER_BIT,this.state.buffers.depth.setMask(!0)),W&&(F|=N.STENCIL_BUFFER_BIT,this.state.buffers.stencil.setMask(4294967295)),F!==0&&N.clear(F)},this.clearColor=function(){this.clear(!0,!1,!1)},this.clearDepth=function(){this.clear(!1,!0,!1)},this.clearStencil=function(){this.clear(!1,!1,!0)},this.setNodesHandler=function(M){M.setRenderer(this),G=M},this.dispose=function(){e.removeEventListener("webglcontextlost",zt,!1),e.removeEventListener("webglcontextrestored",Kt,!1),e.removeEventListener("webglcontextcreationerror",bt,!1),R.dispose(),_t.dispose(),Z.dispose(),qt.dispose(),Gt.dispose(),C.dispose(),it.dispose(),B.dispose(),ct.dispose(),Ft.dispose(),K.dispose(),st.dispose(),st.removeEventListener("sessionstart",$u),st.removeEventListener("sessionend",Yu),qi.stop()};function zt(M){M.preventDefault(),su("WebGLRenderer: Context Lost."),U=!0}function Kt(){su("WebGLRenderer: Context Restored."),U=!1;let M=Le.autoReset,D=dt.enabled,W=dt.autoUpdate,F=dt.needsUpdate,k=dt.type;te(),Le.autoReset=M,dt.enabled=D,dt.autoUpdate=W,dt.needsUpdate=F,dt.type=k}function bt(M){Wt("WebGLRenderer: A WebGL context could not be created. Reason: ",M.statusMessage)}function xe(M){let D=M.target;D.removeEventListener("dispose",xe),Xe(D)}function Xe(M){Ei(M),Gt.remove(M)}function Ei(M){let D=Gt.get(M).programs;D!==void 0&&(D.forEach(function(W){K.releaseProgram(W)}),M.isShaderMaterial&&K.releaseShaderCache(M))}this.renderBufferDirect=function(M,D,W,F,k,xt){D===null&&(D=re);let Rt=k.isMesh&&k.matrixWorld.determinantAffine()<0,pt=ug(M,D,W,F,k);gt.setMaterial(F,Rt);let St=W.index,Dt=1;if(F.wireframe===!0){if(St=B.getWireframeAttribute(W),St===void 0)return;Dt=2}let Zt=W.drawRange,ae=W.attributes.position,Pt=Zt.start*Dt,le=(Zt.start+Zt.count)*Dt;xt!==null&&(Pt=Math.max(Pt,xt.start*Dt),le=Math.min(le,(xt.start+xt.count)*Dt)),St!==null?(Pt=Math.max(Pt,0),le=Math.min(le,St.count)):ae!=null&&(Pt=Math.max(Pt,0),le=Math.min(le,ae.count));let Fe=le-Pt;if(Fe<0||Fe===1/0)return;ct.setup(k,F,pt,W,St);let we,Me=q;if(St!==null&&(we=v.get(St),Me=ft,Me.setIndex(we)),k.isMesh)F.wireframe===!0?(gt.setLineWidth(F.wireframeLinewidth*de()),Me.setMode(N.LINES)):Me.setMode(N.TRIANGLES);else if(k.isLine){let Qe=F.linewidth;Qe===void 0&&(Qe=1),gt.setLineWidth(Qe*de()),k.isLineSegments?Me.setMode(N.LINES):k.isLineLoop?Me.setMode(N.LINE_LOOP):Me.setMode(N.LINE_STRIP)}else k.isPoints?Me.setMode(N.POINTS):k.isSprite&&Me.setMode(N.TRIANGLES);if(k.isBatchedMesh)if(ie.get("WEBGL_multi_draw"))Me.renderMultiDraw(k._multiDrawStarts,k._multiDrawCounts,k._multiDrawCount);else{let Qe=k._multiDrawStarts,It=k._multiDrawCounts,an=k._multiDrawCount,fe=St?v.get(St).bytesPerElement:1,$i=Gt.get(F).currentProgram.getUniforms();for(let tn=0;tn<an;tn++)$i.setValue(N,"_gl_DrawID",tn),Me.render(Qe[tn]/fe,It[tn])}else if(k.isInstancedMesh)Me.renderInstances(Pt,Fe,k.count);else if(W.isInstancedBufferGeometry){let Qe=W._maxInstanceCount!==void 0?W._maxInstanceCount:1/0,It=Math.min(W.instanceCount,Qe);Me.renderInstances(Pt,Fe,It)}else Me.render(Pt,Fe)};function qu(M,D,W,F){G!==null&&M.isNodeMaterial&&G.setObject(F,M),at===!0&&J.setState(M,W,!1),M.transparent===!0&&M.side===rn&&M.forceSinglePass===!1?(M.side=Ge,M.needsUpdate=!0,lr(M,D,F),M.side=bn,M.needsUpdate=!0,lr(M,D,F),M.side=rn):lr(M,D,F)}this.compile=function(M,D,W=null){W===null&&(W=M),G!==null&&G.renderStart(M,D,W),A=Z.get(W),A.init(D),E.push(A),W.traverseVisible(function(k){k.isLight&&k.layers.test(D.layers)&&(A.pushLight(k),k.castShadow&&A.pushShadow(k))}),M!==W&&M.traverseVisible(function(k){k.isLight&&k.layers.test(D.layers)&&(A.pushLight(k),k.castShadow&&A.pushShadow(k))}),A.setupLights(),G!==null&&G.updateLights(A.state.lightsArray),Tt=this.localClippingEnabled,at=J.init(this.clippingPlanes,Tt),at===!0&&J.setGlobalState(this.clippingPlanes,D),G!==null&&dt.render(A.state.shadowsArray,W,D);let F=new Set;return M.traverse(function(k){if(!(k.isMesh||k.isPoints||k.isLine||k.isSprite))return;let xt=k.material;if(xt)if(Array.isArray(xt))for(let Rt=0;Rt<xt.length;Rt++){let pt=xt[Rt];qu(pt,W,D,k),F.add(pt)}else qu(xt,W,D,k),F.add(xt)}),A=E.pop(),G!==null&&G.renderEnd(),F},this.compileAsync=function(M,D,W=null){let F=this.compile(M,D,W);return new Promise(k=>{function xt(){if(F.forEach(function(Rt){let St=Gt.get(Rt).currentProgram;(St===void 0||St.isReady())&&F.delete(Rt)}),F.size===0){k(M);return}setTimeout(xt,10)}ie.get("KHR_parallel_shader_compile")!==null?xt():setTimeout(xt,10)})};let Ic=null;function cg(M){Ic&&Ic(M)}function $u(){qi.stop()}function Yu(){qi.start()}let qi=new Vp;qi.setAnimationLoop(cg),typeof self<"u"&&qi.setContext(self),this.setAnimationLoop=function(M){Ic=M,st.setAnimationLoop(M),M===null?qi.stop():qi.start()},st.addEventListener("sessionstart",$u),st.addEventListener("sessionend",Yu),this.render=function(M,D){if(D!==void 0&&D.isCamera!==!0){Wt("WebGLRenderer.render: camera is not an instance of THREE.Camera.");return}if(U===!0)return;G!==null&&G.renderStart(M,D);let W=st.enabled===!0&&st.isPresenting===!0,F=O!==null&&(nt===null||W)&&O.begin(P,nt);if(M.matrixWorldAutoUpdate===!0&&M.updateMatrixWorld(),D.parent===null&&D.matrixWorldAutoUpdate===!0&&D.updateMatrixWorld(),st.enabled===!0&&st.isPresenting===!0&&(O===null||O.isCompositing()===!1)&&(st.cameraAutoUpdate===!0&&st.updateCamera(D),D=st.getCamera()),M.isScene===!0&&M.onBeforeRender(P,M,D,nt),A=Z.get(M,E.length),A.init(D),A.state.textureUnits=qt.getTextureUnits(),E.push(A),yt.multiplyMatrices(D.projectionMatrix,D.matrixWorldInverse),D.isArrayCamera?ut.setFromArrayCamera(D):tt.setFromProjectionMatrix(yt,Cn,D.reversedDepth),Tt=this.localClippingEnabled,at=J.init(this.clippingPlanes,Tt),T=_t.get(M,_.length),T.init(),_.push(T),this.info.render.frame++,st.enabled===!0&&st.isPresenting===!0){let Rt=P.xr.getDepthSensingMesh();Rt!==null&&Lc(Rt,D,-1/0,P.sortObjects)}Lc(M,D,0,P.sortObjects),T.finish(),G!==null&&G.updateLights(A.state.lightsArray),P.sortObjects===!0&&T.sort(Bt,ye),oe=st.enabled===!1||st.isPresenting===!1||st.hasDepthSensing()===!1,oe&&R.addToRenderList(T,M),this.info.autoReset===!0&&this.info.reset(),at===!0&&J.beginShadows();let k=A.state.shadowsArray;if(dt.render(k,M,D),at===!0&&J.endShadows(),(F&&O.hasRenderPass())===!1){let Rt=T.opaque,pt=T.transmissive;if(A.setupLights(),D.isArrayCamera){let St=D.cameras;if(pt.length>0)for(let Dt=0,Zt=St.length;Dt<Zt;Dt++){let ae=St[Dt];Ju(Rt,pt,M,ae)}oe&&R.render(M);for(let Dt=0,Zt=St.length;Dt<Zt;Dt++){let ae=St[Dt];Zu(T,M,ae,ae.viewport)}}else pt.length>0&&Ju(Rt,pt,M,D),oe&&R.render(M),Zu(T,M,D)}nt!==null&&z===0&&(qt.updateMultisampleRenderTarget(nt),qt.updateRenderTargetMipmap(nt)),F&&O.end(P),M.isScene===!0&&M.onAfterRender(P,M,D),ct.resetDefaultState(),H=-1,Q=null,E.pop(),E.length>0?(A=E[E.length-1],qt.setTextureUnits(A.state.textureUnits),at===!0&&J.setGlobalState(P.clippingPlanes,A.state.camera)):A=null,_.pop(),_.length>0?T=_[_.length-1]:T=null,G!==null&&G.renderEnd()};function Lc(M,D,W,F){if(M.visible===!1)return;if(M.layers.test(D.layers)){if(M.isGroup)W=M.renderOrder;else if(M.isLOD)M.autoUpdate===!0&&M.update(D);else if(M.isLight)A.pushLight(M),M.castShadow&&A.pushShadow(M);else if(M.isSprite){let Rt=D.isArrayCamera?ut:tt;if(!M.frustumCulled||M.intersectsFrustum(Rt)){F&&Ut.setFromMatrixPosition(M.matrixWorld).applyMatrix4(yt);let pt=it.update(M),St=M.material;St.visible&&T.push(M,pt,St,W,Ut.z,null,D)}}else if(M.isMesh||M.isLine||M.isPoints){let Rt=D.isArrayCamera?ut:tt;if(!M.frustumCulled||M.intersectsFrustum(Rt)){let pt=it.update(M),St=M.material;if(F&&(M.boundingSphere!==void 0?(M.boundingSphere===null&&M.computeBoundingSphere(),Ut.copy(M.boundingSphere.center)):(pt.boundingSphere===null&&pt.computeBoundingSphere(),Ut.copy(pt.boundingSphere.center)),Ut.applyMatrix4(M.matrixWorld).applyMatrix4(yt)),Array.isArray(St)){let Dt=pt.groups;for(let Zt=0,ae=Dt.length;Zt<ae;Zt++){let Pt=Dt[Zt],le=St[Pt.materialIndex];le&&le.visible&&T.push(M,pt,le,W,Ut.z,Pt,D)}}else St.visible&&T.push(M,pt,St,W,Ut.z,null,D)}}}let xt=M.children;for(let Rt=0,pt=xt.length;Rt<pt;Rt++)Lc(xt[Rt],D,W,F)}function Zu(M,D,W,F){let{opaque:k,transmissive:xt,transparent:Rt}=M;A.setupLightsView(W),at===!0&&J.setGlobalState(P.clippingPlanes,W),F&&gt.viewport(et.copy(F)),k.length>0&&vo(k,D,W),xt.length>0&&vo(xt,D,W),Rt.length>0&&vo(Rt,D,W),gt.buffers.depth.setTest(!0),gt.buffers.depth.setMask(!0),gt.buffers.color.setMask(!0),gt.setPolygonOffset(!1)}function Ju(M,D,W,F){if((W.isScene===!0?W.overrideMaterial:null)!==null)return;if(A.state.transmissionRenderTarget[F.id]===void 0){let Pt=ie.has("EXT_color_buffer_half_float")||ie.has("EXT_color_buffer_float");A.state.transmissionRenderTarget[F.id]=new Ze(1,1,{generateMipmaps:!0,type:Pt?zn:Mn,minFilter:bi,samples:Math.max(4,be.samples),stencilBuffer:r,resolveDepthBuffer:!1,resolveStencilBuffer:!1,storeMultisampledDepthBuffer:!1,storeMultisampledStencilBuffer:!1,colorSpace:se.workingColorSpace})}let xt=A.state.transmissionRenderTarget[F.id],Rt=F.viewport||et;xt.setSize(Rt.z*P.transmissionResolutionScale,Rt.w*P.transmissionResolutionScale);let pt=P.getRenderTarget(),St=P.getActiveCubeFace(),Dt=P.getActiveMipmapLevel();P.setRenderTarget(xt),P.getClearColor(Y),ht=P.getClearAlpha(),ht<1&&P.setClearColor(16777215,.5),P.clear(),oe&&R.render(W);let Zt=P.toneMapping;P.toneMapping=ti;let ae=F.viewport;if(F.viewport!==void 0&&(F.viewport=void 0),A.setupLightsView(F),at===!0&&J.setGlobalState(P.clippingPlanes,F),vo(M,W,F),qt.updateMultisampleRenderTarget(xt),qt.updateRenderTargetMipmap(xt),ie.has("WEBGL_multisampled_render_to_texture")===!1){let Pt=!1;for(let le=0,Fe=D.length;le<Fe;le++){let we=D[le],{object:Me,geometry:Qe,material:It,group:an}=we;if(It.side===rn&&Me.layers.test(F.layers)){let fe=It.side;It.side=Ge,It.needsUpdate=!0,ju(Me,W,F,Qe,It,an),It.side=fe,It.needsUpdate=!0,Pt=!0}}Pt===!0&&(qt.updateMultisampleRenderTarget(xt),qt.updateRenderTargetMipmap(xt))}P.setRenderTarget(pt,St,Dt),P.setClearColor(Y,ht),ae!==void 0&&(F.viewport=ae),P.toneMapping=Zt}function vo(M,D,W){let F=D.isScene===!0?D.overrideMaterial:null;for(let k=0,xt=M.length;k<xt;k++){let Rt=M[k],{object:pt,geometry:St,group:Dt}=Rt,Zt=Rt.material;Zt.allowOverride===!0&&F!==null&&(Zt=F),pt.layers.test(W.layers)&&ju(pt,D,W,St,Zt,Dt)}}function ju(M,D,W,F,k,xt){G!==null&&k.isNodeMaterial&&G.setObject(M,k),M.onBeforeRender(P,D,W,F,k,xt),M.modelViewMatrix.multiplyMatrices(W.matrixWorldInverse,M.matrixWorld),M.normalMatrix.getNormalMatrix(M.modelViewMatrix),k.onBeforeRender(P,D,W,F,M,xt),k.transparent===!0&&k.side===rn&&k.forceSinglePass===!1?(k.side=Ge,k.needsUpdate=!0,P.renderBufferDirect(W,D,F,k,M,xt),k.side=bn,k.needsUpdate=!0,P.renderBufferDirect(W,D,F,k,M,xt),k.side=rn):P.renderBufferDirect(W,D,F,k,M,xt),M.onAfterRender(P,D,W,F,k,xt)}function Ku(M){let D=0;for(let W of M)W.texture!==null&&D++;return D}function lr(M,D,W){D.isScene!==!0&&(D=re);let F=Gt.get(M),k=A.state.lights,xt=A.state.shadowsArray,Rt=k.state.version,pt=K.getParameters(M,k.state,xt,D,W,A.state.lightProbeGridArray),St=K.getProgramCacheKey(pt),Dt=F.programs;F.environment=M.isMeshStandardMaterial||M.isMeshLambertMaterial||M.isMeshPhongMaterial?D.environment:null,F.fog=D.fog;let Zt=M.isMeshStandardMaterial||M.isMeshLambertMaterial&&!M.envMap||M.isMeshPhongMaterial&&!M.envMap;F.envMap=C.get(M.envMap||F.environment,Zt),F.envMapRotation=F.environment!==null&&M.envMap===null?D.environmentRotation:M.envMapRotation,Dt===void 0&&(M.addEventListener("dispose",xe),Dt=new Map,F.programs=Dt,F.programVariants=new Map);let ae=Dt.get(St);if(ae!==void 0){if(F.currentProgram===ae&&F.lightsStateVersion===Rt)return td(M,pt),ae}else pt.uniforms=K.getUniforms(M),G!==null&&M.isNodeMaterial&&G.build(M,W,pt),M.onBeforeCompile(pt,P),ae=K.acquireProgram(pt,St),Dt.set(St,ae),F.uniforms=pt.uniforms;let Pt=F.uniforms;return(!M.isShaderMaterial&&!M.isRawShaderMaterial||M.clipping===!0)&&(Pt.clippingPlanes=J.uniform),td(M,pt),F.needsLights=fg(M),F.lightsStateVersion=Rt,F.needsLights&&(Pt.ambientLightColor.value=k.state.ambient,Pt.lightProbe.value=k.state.probe,Pt.sunLights.value=k.state.sun,Pt.sunLightShadows.value=k.state.sunShadow,Pt.directionalLights.value=k.state.directional,Pt.directionalLightShadows.value=k.state.directionalShadow,Pt.spotLights.value=k.state.spot,Pt.spotLightShadows.value=k.state.spotShadow,Pt.rectAreaLights.value=k.state.rectArea,Pt.ltc_1.value=k.state.rectAreaLTC1,Pt.ltc_2.value=k.state.rectAreaLTC2,Pt.pointLights.value=k.state.point,Pt.pointLightShadows.value=k.state.pointShadow,Pt.hemisphereLights.value=k.state.hemi,Pt.sunShadowMatrix.value=k.state.sunShadowMatrix,Pt.sunShadowCascade.value=k.state.sunShadowCascade,Pt.directionalShadowMatrix.value=k.state.directionalShadowMatrix,Pt.spotLightMatrix.value=k.state.spotLightMatrix,Pt.spotLightMap.value=k.state.spotLightMap,Pt.pointShadowMatrix.value=k.state.pointShadowMatrix),F.numLightProbeGrids=Ku(A.state.lightProbeGridArray),F.currentProgram=ae,F.uniformsList=null,ae}function hg(M,D,W,F,k){let xt=Gt.get(M),Rt=xt.currentProgram.id+","+F+","+k,pt=xt.programVariants.get(Rt);return pt===void 0?(pt=lr(M,D,W),xt.programVariants.set(Rt,pt)):(xt.currentProgram=pt,xt.uniformsList=null,xt.outputColorSpace=F,xt.toneMapping=k),pt}function Qu(M){if(M.uniformsList===null){let D=M.currentProgram.getUniforms();M.uniformsList=js.seqWithValue(D.seq,M.uniforms)}return M.uniformsList}function td(M,D){let W=Gt.get(M);W.outputColorSpace=D.outputColorSpace,W.batching=D.batching,W.batchingColor=D.batchingColor,W.instancing=D.instancing,W.instancingColor=D.instancingColor,W.instancingMorph=D.instancingMorph,W.skinning=D.skinning,W.morphTargets=D.morphTargets,W.morphNormals=D.morphNormals,W.morphColors=D.morphColors,W.morphTargetsCount=D.morphTargetsCount,W.numClippingPlanes=D.numClippingPlanes,W.numIntersection=D.numClipIntersection,W.vertexAlphas=D.vertexAlphas,W.vertexTangents=D.vertexTangents,W.toneMapping=D.toneMapping}function ug(M,D,W,F,k){D.isScene!==!0&&(D=re),qt.resetTextureUnits();let xt=D.fog,Rt=F.isMeshStandardMaterial||F.isMeshLambertMaterial||F.isMeshPhongMaterial?D.environment:null,pt=nt===null?P.outputColorSpace:nt.isXRRenderTarget===!0?nt.texture.colorSpace:se.workingColorSpace,St=F.isMeshStandardMaterial||F.isMeshLambertMaterial&&!F.envMap||F.isMeshPhongMaterial&&!F.envMap,Dt=C.get(F.envMap||Rt,St),Zt=F.vertexColors===!0&&!!W.attributes.color&&W.attributes.color.itemSize===4,ae=!!W.attributes.tangent&&(!!F.normalMap||F.anisotropy>0),Pt=!!W.morphAttributes.position,le=!!W.morphAttributes.normal,Fe=!!W.morphAttributes.color,we=ti;F.toneMapped&&(nt===null||nt.isXRRenderTarget===!0)&&(we=P.toneMapping);let Me=W.morphAttributes.position||W.morphAttributes.normal||W.morphAttributes.color,Qe=Me!==void 0?Me.length:0,It=Gt.get(F),an=A.state.lights;if(at===!0&&(Tt===!0||M!==Q)){let Re=M===Q&&F.id===H;J.setState(F,M,Re)}let fe=!1,$i=!1;F.version===It.__version?It.needsLights&&It.lightsStateVersion!==an.state.version||k.isBatchedMesh&&It.batching===!1||!k.isBatchedMesh&&It.batching===!0||k.isBatchedMesh&&It.batchingColor===!0&&k._colorsTexture===null||k.isBatchedMesh&&It.batchingColor===!1&&k._colorsTexture!==null||k.isInstancedMesh&&It.instancing===!1||!k.isInstancedMesh&&It.instancing===!0||k.isSkinnedMesh&&It.skinning===!1||!k.isSkinnedMesh&&It.skinning===!0||k.isInstancedMesh&&It.instancingColor===!0&&k.instanceColor===null||k.isInstancedMesh&&It.instancingColor===!1&&k.instanceColor!==null||k.isInstancedMesh&&It.instancingMorph===!0&&k.morphTexture===null||k.isInstancedMesh&&It.instancingMorph===!1&&k.morphTexture!==null||It.envMap!==Dt||F.fog===!0&&It.fog!==xt||It.numClippingPlanes!==void 0&&(It.numClippingPlanes!==J.numPlanes||It.numIntersection!==J.numIntersection)||It.vertexAlphas!==Zt||It.vertexTangents!==ae||It.morphTargets!==Pt||It.morphNormals!==le||It.morphColors!==Fe||It.morphTargetsCount!==Qe||It.numLightProbeGrids!==Ku(A.state.lightProbeGridArray)?fe=!0:(It.outputColorSpace!==pt||It.toneMapping!==we)&&($i=!0):(fe=!0,It.__version=F.version);let tn=It.currentProgram;(fe===!0||$i===!0)&&(tn=$i===!0?hg(F,D,k,pt,we):lr(F,D,k),G&&F.isNodeMaterial&&G.onUpdateProgram(F,tn,It));let yo=!1,Ai=!1,Yi=!1,he=tn.getUniforms(),Ke=It.uniforms;if(gt.useProgram(tn.program)&&(yo=!0,Ai=!0,Yi=!0),F.id!==H&&(H=F.id,Ai=!0),yo||Q!==M){gt.buffers.depth.getReversed()&&M.reversedDepth!==!0&&(M._reversedDepth=!0,M.updateProjectionMatrix()),he.setValue(N,"projectionMatrix",M.projectionMatrix),he.setValue(N,"viewMatrix",M.matrixWorldInverse);let qe=he.map.cameraPosition;qe!==void 0&&qe.setValue(N,Jt.setFromMatrixPosition(M.matrixWorld)),be.logarithmicDepthBuffer&&he.setValue(N,"logDepthBufFC",2/(Math.log(M.far+1)/Math.LN2)),(F.isMeshPhongMaterial||F.isMeshToonMaterial||F.isMeshLambertMaterial||F.isMeshBasicMaterial||F.isMeshStandardMaterial||F.isShaderMaterial)&&he.setValue(N,"isOrthographic",M.isOrthographicCamera===!0),Q!==M&&(Q=M,Ai=!0,Yi=!0)}if(It.needsLights&&(an.state.sunShadowMap.length>0&&he.setValue(N,"sunShadowMap",an.state.sunShadowMap,qt),an.state.directionalShadowMap.length>0&&he.setValue(N,"directionalShadowMap",an.state.directionalShadowMap,qt),an.state.spotShadowMap.length>0&&he.setValue(N,"spotShadowMap",an.state.spotShadowMap,qt),an.state.pointShadowMap.length>0&&he.setValue(N,"pointShadowMap",an.state.pointShadowMap,qt)),k.isSkinnedMesh){he.setOptional(N,k,"bindMatrix"),he.setOptional(N,k,"bindMatrixInverse");let Re=k.skeleton;Re&&(Re.boneTexture===null&&Re.computeBoneTexture(),he.setValue(N,"boneTexture",Re.boneTexture,qt))}k.isBatchedMesh&&(he.setOptional(N,k,"batchingTexture"),he.setValue(N,"batchingTexture",k._matricesTexture,qt),he.setOptional(N,k,"batchingIdTexture"),he.setValue(N,"batchingIdTexture",k._indirectTexture,qt),he.setOptional(N,k,"batchingColorTexture"),k._colorsTexture!==null&&he.setValue(N,"batchingColorTexture",k._colorsTexture,qt));let Pn=W.morphAttributes;if((Pn.position!==void 0||Pn.normal!==void 0||Pn.color!==void 0)&&j.update(k,W,tn),(Ai||It.receiveShadow!==k.receiveShadow)&&(It.receiveShadow=k.receiveShadow,he.setValue(N,"receiveShadow",k.receiveShadow)),(F.isMeshStandardMaterial||F.isMeshLambertMaterial||F.isMeshPhongMaterial)&&F.envMap===null&&D.environment!==null&&(Ke.envMapIntensity.value=D.environmentIntensity),Ke.dfgLUT!==void 0&&(Ke.dfgLUT.value=MM()),Ai){if(he.setValue(N,"toneMappingExposure",P.toneMappingExposure),It.needsLights&&dg(Ke,Yi),xt&&F.fog===!0&&lt.refreshFogUniforms(Ke,xt),lt.refreshMaterialUniforms(Ke,F,vt,Ot,A.state.transmissionRenderTarget[M.id]),It.needsLights&&It.numLightProbeGrids>0){let Re=S,qe=0;for(let si of A.state.lightProbeGridArray)si.texture!==null&&(Re.textures[qe]=si.texture,Re.min[qe]=si.boundingBox.min,Re.max[qe]=si.boundingBox.max,Re.resolution[qe]=si.resolution,qe++);for(let si in Re)Re[si].length=qe;Ke.probesSH.value=Re.textures,Ke.probesMin.value=Re.min,Ke.probesMax.value=Re.max,Ke.probesResolution.value=Re.resolution}js.upload(N,Qu(It),Ke,qt)}if(F.isShaderMaterial&&F.uniformsNeedUpdate===!0&&(js.upload(N,Qu(It),Ke,qt),F.uniformsNeedUpdate=!1),F.isSpriteMaterial&&he.setValue(N,"center",k.center),he.setValue(N,"modelViewMatrix",k.modelViewMatrix),he.setValue(N,"normalMatrix",k.normalMatrix),he.setValue(N,"modelMatrix",k.matrixWorld),F.uniformsGroups!==void 0){let Re=F.uniformsGroups;for(let qe=0,si=Re.length;qe<si;qe++){let nd=Re[qe];Ft.update(nd,tn),Ft.bind(nd,tn)}}return tn}function dg(M,D){M.ambientLightColor.needsUpdate=D,M.lightProbe.needsUpdate=D,M.sunLights.needsUpdate=D,M.sunLightShadows.needsUpdate=D,M.directionalLights.needsUpdate=D,M.directionalLightShadows.needsUpdate=D,M.pointLights.needsUpdate=D,M.pointLightShadows.needsUpdate=D,M.spotLights.needsUpdate=D,M.spotLightShadows.needsUpdate=D,M.rectAreaLights.needsUpdate=D,M.hemisphereLights.needsUpdate=D}function fg(M){return M.isMeshLambertMaterial||M.isMeshToonMaterial||M.isMeshPhongMaterial||M.isMeshStandardMaterial||M.isShadowMaterial||M.isShaderMaterial&&M.lights===!0}this.getActiveCubeFace=function(){return X},this.getActiveMipmapLevel=function(){return z},this.getRenderTarget=function(){return nt},this.setRenderTargetTextures=function(M,D,W){let F=Gt.get(M);F.__autoAllocateDepthBuffer=M.resolveDepthBuffer===!1,F.__autoAllocateDepthBuffer===!1&&(F.__useRenderToTexture=!1),Gt.get(M.texture).__webglTexture=D,Gt.get(M.depthTexture).__webglTexture=F.__autoAllocateDepthBuffer?void 0:W,F.__hasExternalTextures=!0},this.setRenderTargetFramebuffer=function(M,D){let W=Gt.get(M);W.__webglFramebuffer=D,W.__useDefaultFramebuffer=D===void 0},this.setRenderTarget=function(M,D=0,W=0){nt=M,X=D,z=W;let F=null,k=!1,xt=!1;if(M){let pt=Gt.get(M);if(pt.__useDefaultFramebuffer!==void 0){gt.bindFramebuffer(N.FRAMEBUFFER,pt.__webglFramebuffer),et.copy(M.viewport),Et.copy(M.scissor),Nt=M.scissorTest,gt.viewport(et),gt.scissor(Et),gt.setScissorTest(Nt),H=-1;return}else if(pt.__webglFramebuffer===void 0)qt.setupRenderTarget(M);else if(pt.__hasExternalTextures)qt.rebindTextures(M,Gt.get(M.texture).__webglTexture,Gt.get(M.depthTexture).__webglTexture);else if(M.depthBuffer){let Zt=M.depthTexture;if(pt.__boundDepthTexture!==Zt){if(Zt!==null&&Gt.has(Zt)&&(M.width!==Zt.image.width||M.height!==Zt.image.height))throw new Error("THREE.WebGLRenderer: Attached DepthTexture is initialized to the incorrect size.");qt.setupDepthRenderbuffer(M)}}let St=M.texture;(St.isData3DTexture||St.isDataArrayTexture||St.isCompressedArrayTexture)&&(xt=!0);let Dt=Gt.get(M).__webglFramebuffer;M.isWebGLCubeRenderTarget?(Array.isArray(Dt[D])?F=Dt[D][W]:F=Dt[D],k=!0):M.samples>0&&qt.useMultisampledRTT(M)===!1?F=Gt.get(M).__webglMultisampledFramebuffer:Array.isArray(Dt)?F=Dt[W]:F=Dt,et.copy(M.viewport),Et.copy(M.scissor),Nt=M.scissorTest}else et.copy(kt).multiplyScalar(vt).floor(),Et.copy(jt).multiplyScalar(vt).floor(),Nt=Qt;if(W!==0&&(F=$),gt.bindFramebuffer(N.FRAMEBUFFER,F)&&gt.drawBuffers(M,F),gt.viewport(et),gt.scissor(Et),gt.setScissorTest(Nt),k){let pt=Gt.get(M.texture);N.framebufferTexture2D(N.FRAMEBUFFER,N.COLOR_ATTACHMENT0,N.TEXTURE_CUBE_MAP_POSITIVE_X+D,pt.__webglTexture,W)}else if(xt){let pt=D;for(let St=0;St<M.textures.length;St++){let Dt=Gt.get(M.textures[St]);N.framebufferTextureLayer(N.FRAMEBUFFER,N.COLOR_ATTACHMENT0+St,Dt.__webglTexture,W,pt)}}else if(M!==null&&W!==0){let pt=Gt.get(M.texture);N.framebufferTexture2D(N.FRAMEBUFFER,N.COLOR_ATTACHMENT0,N.TEXTURE_2D,pt.__webglTexture,W)}H=-1};function ed(M){let D=Gt.get(M);return(D.__readFormat!==M.format||D.__readType!==M.type)&&(D.__readFormat=M.format,D.__readType=M.type,D.__formatReadable=be.textureFormatReadable(M.format),D.__typeReadable=be.textureTypeReadable(M.type)),D}this.readRenderTargetPixels=function(M,D,W,F,k,xt,Rt,pt=0){if(!(M&&M.isWebGLRenderTarget)){Wt("WebGLRenderer.readRenderTargetPixels: renderTarget is not THREE.WebGLRenderTarget.");return}let St=Gt.get(M).__webglFramebuffer;if(M.isWebGLCubeRenderTarget&&Rt!==void 0&&(St=St[Rt],Array.isArray(St)&&(St=St[0])),St){gt.bindFramebuffer(N.FRAMEBUFFER,St);try{let Dt=M.textures[pt],Zt=Dt.format,ae=Dt.type;M.textures.length>1&&N.readBuffer(N.COLOR_ATTACHMENT0+pt);let Pt=ed(Dt);if(Pt.__formatReadable===!1){Wt("WebGLRenderer.readRenderTargetPixels: renderTarget is not in RGBA or implementation defined format.");return}if(Pt.__typeReadable===!1){Wt("WebGLRenderer.readRenderTargetPixels: renderTarget is not in UnsignedByteType or implementation defined type.");return}D>=0&&D<=M.width-F&&W>=0&&W<=M.height-k&&N.readPixels(D,W,F,k,ot.convert(Zt),ot.convert(ae),xt)}finally{let Dt=nt!==null?Gt.get(nt).__webglFramebuffer:null;gt.bindFramebuffer(N.FRAMEBUFFER,Dt)}}},this.readRenderTargetPixelsAsync=async function(M,D,W,F,k,xt,Rt,pt=0){if(!(M&&M.isWebGLRenderTarget))throw new Error("THREE.WebGLRenderer.readRenderTargetPixels: renderTarget is not THREE.WebGLRenderTarget.");let St=Gt.get(M).__webglFramebuffer;if(M.isWebGLCubeRenderTarget&&Rt!==void 0&&(St=St[Rt],Array.isArray(St)&&(St=St[0])),St)if(D>=0&&D<=M.width-F&&W>=0&&W<=M.height-k){gt.bindFramebuffer(N.FRAMEBUFFER,St);let Dt=M.textures[pt],Zt=Dt.format,ae=Dt.type;M.textures.length>1&&N.readBuffer(N.COLOR_ATTACHMENT0+pt);let Pt=ed(Dt);if(Pt.__formatReadable===!1)throw new Error("THREE.WebGLRenderer.readRenderTargetPixelsAsync: renderTarget is not in RGBA or implementation defined format.");if(Pt.__typeReadable===!1)throw new Error("THREE.WebGLRenderer.readRenderTargetPixelsAsync: renderTarget is not in UnsignedByteType or implementation defined type.");let le=N.createBuffer();N.bindBuffer(N.PIXEL_PACK_BUFFER,le),N.bufferData(N.PIXEL_PACK_BUFFER,xt.byteLength,N.STREAM_READ),N.readPixels(D,W,F,k,ot.convert(Zt),ot.convert(ae),0),N.bindBuffer(N.PIXEL_PACK_BUFFER,null);let Fe=nt!==null?Gt.get(nt).__webglFramebuffer:null;gt.bindFramebuffer(N.FRAMEBUFFER,Fe);let we=N.fenceSync(N.SYNC_GPU_COMMANDS_COMPLETE,0);return N.flush(),await cp(N,we,4),N.bindBuffer(N.PIXEL_PACK_BUFFER,le),N.getBufferSubData(N.PIXEL_PACK_BUFFER,0,xt),N.bindBuffer(N.PIXEL_PACK_BUFFER,null),N.deleteBuffer(le),N.deleteSync(we),xt}else throw new Error("THREE.WebGLRenderer.readRenderTargetPixelsAsync: requested read bounds are out of range.")},this.copyFramebufferToTexture=function(M,D=null,W=0){let F=Math.pow(2,-W),k=Math.floor(M.image.width*F),xt=Math.floor(M.image.height*F),Rt=D!==null?D.x:0,pt=D!==null?D.y:0;qt.setTexture2D(M,0),N.copyTexSubImage2D(N.TEXTURE_2D,W,0,0,Rt,pt,k,xt),gt.unbindTexture()},this.copyTextureToTexture=function(M,D,W=null,F=null,k=0,xt=0){let Rt,pt,St,Dt,Zt,ae,Pt,le,Fe,we=M.isCompressedTexture?M.mipmaps[xt]:M.image;if(W!==null)Rt=W.max.x-W.min.x,pt=W.max.y-W.min.y,St=W.isBox3?W.max.z-W.min.z:1,Dt=W.min.x,Zt=W.min.y,ae=W.isBox3?W.min.z:0;else{let he=Math.pow(2,-k);Rt=Math.floor(we.width*he),pt=Math.floor(we.height*he),M.isDataArrayTexture?St=we.depth:M.isData3DTexture?St=Math.floor(we.depth*he):St=1,Dt=0,Zt=0,ae=0}F!==null?(Pt=F.x,le=F.y,Fe=F.z):(Pt=0,le=0,Fe=0);let Me=ot.convert(D.format),Qe=ot.convert(D.type),It;D.isData3DTexture?(qt.setTexture3D(D,0),It=N.TEXTURE_3D):D.isDataArrayTexture||D.isCompressedArrayTexture?(qt.setTexture2DArray(D,0),It=N.TEXTURE_2D_ARRAY):(qt.setTexture2D(D,0),It=N.TEXTURE_2D),gt.activeTexture(N.TEXTURE0),gt.pixelStorei(N.UNPACK_FLIP_Y_WEBGL,D.flipY),gt.pixelStorei(N.UNPACK_PREMULTIPLY_ALPHA_WEBGL,D.premultiplyAlpha),gt.pixelStorei(N.UNPACK_ALIGNMENT,D.unpackAlignment);let an=gt.getParameter(N.UNPACK_ROW_LENGTH),fe=gt.getParameter(N.UNPACK_IMAGE_HEIGHT),$i=gt.getParameter(N.UNPACK_SKIP_PIXELS),tn=gt.getParameter(N.UNPACK_SKIP_ROWS),yo=gt.getParameter(N.UNPACK_SKIP_IMAGES);gt.pixelStorei(N.UNPACK_ROW_LENGTH,we.width),gt.pixelStorei(N.UNPACK_IMAGE_HEIGHT,we.height),gt.pixelStorei(N.UNPACK_SKIP_PIXELS,Dt),gt.pixelStorei(N.UNPACK_SKIP_ROWS,Zt),gt.pixelStorei(N.UNPACK_SKIP_IMAGES,ae);let Ai=M.isDataArrayTexture||M.isData3DTexture,Yi=D.isDataArrayTexture||D.isData3DTexture;if(M.isDepthTexture){let he=Gt.get(M),Ke=Gt.get(D),Pn=Gt.get(he.__renderTarget),Re=Gt.get(Ke.__renderTarget);gt.bindFramebuffer(N.READ_FRAMEBUFFER,Pn.__webglFramebuffer),gt.bindFramebuffer(N.DRAW_FRAMEBUFFER,Re.__webglFramebuffer);for(let qe=0;qe<St;qe++)Ai&&(N.framebufferTextureLayer(N.READ_FRAMEBUFFER,N.COLOR_ATTACHMENT0,Gt.get(M).__webglTexture,k,ae+qe),N.framebufferTextureLayer(N.DRAW_FRAMEBUFFER,N.COLOR_ATTACHMENT0,Gt.get(D).__webglTexture,xt,Fe+qe)),N.blitFramebuffer(Dt,Zt,Dt+Rt,Zt+pt,Pt,le,Pt+Rt,le+pt,N.DEPTH_BUFFER_BIT,N.NEAREST);gt.bindFramebuffer(N.READ_FRAMEBUFFER,null),gt.bindFramebuffer(N.DRAW_FRAMEBUFFER,null)}else if(k!==0||M.isRenderTargetTexture||Gt.has(M)){let he=Gt.get(M),Ke=Gt.get(D);gt.bindFramebuffer(N.READ_FRAMEBUFFER,L),gt.bindFramebuffer(N.DRAW_FRAMEBUFFER,V);for(let Pn=0;Pn<St;Pn++)Ai?N.framebufferTextureLayer(N.READ_FRAMEBUFFER,N.COLOR_ATTACHMENT0,he.__webglTexture,k,ae+Pn):N.framebufferTexture2D(N.READ_FRAMEBUFFER,N.COLOR_ATTACHMENT0,N.TEXTURE_2D,he.__webglTexture,k),Yi?N.framebufferTextureLayer(N.DRAW_FRAMEBUFFER,N.COLOR_ATTACHMENT0,Ke.__webglTexture,xt,Fe+Pn):N.framebufferTexture2D(N.DRAW_FRAMEBUFFER,N.COLOR_ATTACHMENT0,N.TEXTURE_2D,Ke.__webglTexture,xt),k!==0?N.blitFramebuffer(Dt,Zt,Dt+Rt,Zt+pt,Pt,le,Pt+Rt,le+pt,N.COLOR_BUFFER_BIT,N.NEAREST):Yi?N.copyTexSubImage3D(It,xt,Pt,le,Fe+Pn,Dt,Zt,Rt,pt):N.copyTexSubImage2D(It,xt,Pt,le,Dt,Zt,Rt,pt);gt.bindFramebuffer(N.READ_FRAMEBUFFER,null),gt.bindFramebuffer(N.DRAW_FRAMEBUFFER,null)}else Yi?M.isDataTexture||M.isData3DTexture?N.texSubImage3D(It,xt,Pt,le,Fe,Rt,pt,St,Me,Qe,we.data):D.isCompressedArrayTexture?N.compressedTexSubImage3D(It,xt,Pt,le,Fe,Rt,pt,St,Me,we.data):N.texSubImage3D(It,xt,Pt,le,Fe,Rt,pt,St,Me,Qe,we):M.isDataTexture?N.texSubImage2D(N.TEXTURE_2D,xt,Pt,le,Rt,pt,Me,Qe,we.data):M.isCompressedTexture?N.compressedTexSubImage2D(N.TEXTURE_2D,xt,Pt,le,we.width,we.height,Me,we.data):N.texSubImage2D(N.TEXTURE_2D,xt,Pt,le,Rt,pt,Me,Qe,we);gt.pixelStorei(N.UNPACK_ROW_LENGTH,an),gt.pixelStorei(N.UNPACK_IMAGE_HEIGHT,fe),gt.pixelStorei(N.UNPACK_SKIP_PIXELS,$i),gt.pixelStorei(N.UNPACK_SKIP_ROWS,tn),gt.pixelStorei(N.UNPACK_SKIP_IMAGES,yo),xt===0&&D.generateMipmaps===!0&&D.mipmapsAutoUpdate===!0&&N.generateMipmap(It),gt.unbindTexture()},this.initRenderTarget=function(M){Gt.get(M).__webglFramebuffer===void 0&&qt.setupRenderTarget(M)},this.initTexture=function(M){M.isCubeTexture?qt.setTextureCube(M,0):M.isData3DTexture?qt.setTexture3D(M,0):M.isDataArrayTexture||M.isCompressedArrayTexture?qt.setTexture2DArray(M,0):qt.setTexture2D(M,0),gt.unbindTexture()},this.resetState=function(){X=0,z=0,nt=null,gt.reset(),ct.reset()},typeof __THREE_DEVTOOLS__<"u"&&__THREE_DEVTOOLS__.dispatchEvent(new CustomEvent("observe",{detail:this}))}get coordinateSystem(){return Cn}get outputColorSpace(){return this._outputColorSpace}set outputColorSpace(t){this._outputColorSpace=t;let e=this.getContext();e.drawingBufferColorSpace=se._getDrawingBufferColorSpace(t),e.unpackColorSpace=se._getUnpackColorSpace()}};var Qp={type:"change"},Eu={type:"start"},em={type:"end"},Kl=new xi,tm=new xn,SM=Math.cos(70*lu.DEG2RAD),We=new I,pn=2*Math.PI,ge={NONE:-1,ROTATE:0,DOLLY:1,PAN:2,TOUCH_ROTATE:3,TOUCH_PAN:4,TOUCH_DOLLY_PAN:5,TOUCH_DOLLY_ROTATE:6},wu=1e-6,Ql=class extends Qr{constructor(t,e=null){super(t,e),this.state=ge.NONE,this.target=new I,this.cursor=new I,this.minDistance=0,this.maxDistance=1/0,this.minZoom=0,this.maxZoom=1/0,this.minTargetRadius=0,this.maxTargetRadius=1/0,this.minPolarAngle=0,this.maxPolarAngle=Math.PI,this.minAzimuthAngle=-1/0,this.maxAzimuthAngle=1/0,this.enableDamping=!1,this.dampingFactor=.05,this.enableZoom=!0,this.zoomSpeed=1,this.enableRotate=!0,this.rotateSpeed=1,this.keyRotateSpeed=1,this.enablePan=!0,this.panSpeed=1,this.screenSpacePanning=!0,this.keyPanSpeed=7,this.zoomToCursor=!1,this.autoRotate=!1,this.autoRotateSpeed=2,this.keys={LEFT:"ArrowLeft",UP:"ArrowUp",RIGHT:"ArrowRight",BOTTOM:"ArrowDown"},this.mouseButtons={LEFT:Vi.ROTATE,MIDDLE:Vi.DOLLY,RIGHT:Vi.PAN},this.touches={ONE:Hi.ROTATE,TWO:Hi.DOLLY_PAN},this.target0=this.target.clone(),this.position0=this.object.position.clone(),this.zoom0=this.object.zoom,this._cursorStyle="auto",this._domElementKeyEvents=null,this._lastPosition=new I,this._lastQuaternion=new Ue,this._lastTargetPosition=new I,this._quat=new Ue().setFromUnitVectors(t.up,new I(0,1,0)),this._quatInverse=this._quat.clone().invert(),this._spherical=new Qn,this._sphericalDelta=new Qn,this._scale=1,this._panOffset=new I,this._rotateStart=new rt,this._rotateEnd=new rt,this._rotateDelta=new rt,this._panStart=new rt,this._panEnd=new rt,this._panDelta=new rt,this._dollyStart=new rt,this._dollyEnd=new rt,this._dollyDelta=new rt,this._dollyDirection=new I,this._mouse=new rt,this._performCursorZoom=!1,this._pointers=[],this._pointerPositions={},this._controlActive=!1,this._onPointerMove=EM.bind(this),this._onPointerDown=wM.bind(this),this._onPointerUp=AM.bind(this),this._onContextMenu=DM.bind(this),this._onMouseWheel=RM.bind(this),this._onKeyDown=PM.bind(this),this._onTouchStart=IM.bind(this),this._onTouchMove=LM.bind(this),this._onMouseDown=TM.bind(this),this._onMouseMove=CM.bind(this),this._interceptControlDown=NM.bind(this),this._interceptControlUp=UM.bind(this),this.domElement!==null&&this.connect(this.domElement),this.update()}set cursorStyle(t){this._cursorStyle=t,t==="grab"?this.domElement.style.cursor="grab":this.domElement.style.cursor="auto"}get cursorStyle(){return this._cursorStyle}connect(t){super.connect(t),this.domElement.addEventListener("pointerdown",this._onPointerDown),this.domElement.addEventListener("pointercancel",this._onPointerUp),this.domElement.addEventListener("contextmenu",this._onContextMenu),this.domElement.addEventListener("wheel",this._onMouseWheel,{passive:!1}),this.domElement.ownerDocument.addEventListener("keydown",this._interceptControlDown,{passive:!0,capture:!0}),this.domElement.style.touchAction="none"}disconnect(){this.state=ge.NONE,this.domElement.removeEventListener("pointerdown",this._onPointerDown),this.domElement.ownerDocument.removeEventListener("pointermove",this._onPointerMove),this.domElement.ownerDocument.removeEventListener("pointerup",this._onPointerUp),this.domElement.removeEventListener("pointercancel",this._onPointerUp),this.domElement.removeEventListener("wheel",this._onMouseWheel),this.domElement.removeEventListener("contextmenu",this._onContextMenu),this.stopListenToKeyEvents(),this.domElement.ownerDocument.removeEventListener("keydown",this._interceptControlDown,{capture:!0}),this.domElement.ownerDocument.removeEventListener("keyup",this._interceptControlUp,{capture:!0}),this._controlActive=!1,this._pointers.length=0,this._pointerPositions={},this.domElement.style.touchAction="",this.domElement.style.cursor="auto"}dispose(){this.disconnect()}getPolarAngle(){return this._spherical.phi}getAzimuthalAngle(){return this._spherical.theta}getDistance(){return this.object.position.distanceTo(this.target)}listenToKeyEvents(t){t.addEventListener("keydown",this._onKeyDown),this._domElementKeyEvents=t}stopListenToKeyEvents(){this._domElementKeyEvents!==null&&(this._domElementKeyEvents.removeEventListener("keydown",this._onKeyDown),this._domElementKeyEvents=null)}saveState(){this.target0.copy(this.target),this.position0.copy(this.object.position),this.zoom0=this.object.zoom}reset(){this.target.copy(this.target0),this.object.position.copy(this.position0),this.object.zoom=this.zoom0,this.object.updateProjectionMatrix(),this.dispatchEvent(Qp),this.update(),this.state=ge.NONE}pan(t,e){this._pan(t,e),this.update()}dollyIn(t){this._dollyIn(t),this.update()}dollyOut(t){this._dollyOut(t),this.update()}rotateLeft(t){this._rotateLeft(t),this.update()}rotateUp(t){this._rotateUp(t),this.update()}update(t=null){let e=this.object.position;We.copy(e).sub(this.target),We.applyQuaternion(this._quat),this._spherical.setFromVector3(We),this.autoRotate&&this.state===ge.NONE&&this._rotateLeft(this._getAutoRotationAngle(t)),this.enableDamping?(this._spherical.theta+=this._sphericalDelta.theta*this.dampingFactor,this._spherical.phi+=this._sphericalDelta.phi*this.dampingFactor):(this._spherical.theta+=this._sphericalDelta.theta,this._spherical.phi+=this._sphericalDelta.phi);let n=this.minAzimuthAngle,s=this.maxAzimuthAngle;isFinite(n)&&isFinite(s)&&(n<-Math.PI?n+=pn:n>Math.PI&&(n-=pn),s<-Math.PI?s+=pn:s>Math.PI&&(s-=pn),n<=s?this._spherical.theta=Math.max(n,Math.min(s,this._spherical.theta)):this._spherical.theta=this._spherical.theta>(n+s)/2?Math.max(n,this._spherical.theta):Math.min(s,this._spherical.theta)),this._spherical.phi=Math.max(this.minPolarAngle,Math.min(this.maxPolarAngle,this._spherical.phi)),this._spherical.makeSafe(),this.enableDamping===!0?this.target.addScaledVector(this._panOffset,this.dampingFactor):this.target.add(this._panOffset),this.target.sub(this.cursor),this.target.clampLength(this.minTargetRadius,this.maxTargetRadius),this.target.add(this.cursor);let r=!1;if(this.zoomToCursor&&this._performCursorZoom||this.object.isOrthographicCamera)this._spherical.radius=this._clampDistance(this._spherical.radius);else{let o=this._spherical.radius;this._spherical.radius=this._clampDistance(this._spherical.radius*this._scale),r=o!=this._spherical.radius}if(We.setFromSpherical(this._spherical),We.applyQuaternion(this._quatInverse),e.copy(this.target).add(We),this.object.lookAt(this.target),this.enableDamping===!0?(this._sphericalDelta.theta*=1-this.dampingFactor,this._sphericalDelta.phi*=1-this.dampingFactor,this._panOffset.multiplyScalar(1-this.dampingFactor)):(this._sphericalDelta.set(0,0,0),this._panOffset.set(0,0,0)),this.zoomToCursor&&this._performCursorZoom){let o=null;if(this.object.isPerspectiveCamera){let a=We.length();o=this._clampDistance(a*this._scale);let l=a-o;this.object.position.addScaledVector(this._dollyDirection,l),this.object.updateMatrixWorld(),r=!!l}else if(this.object.isOrthographicCamera){let a=new I(this._mouse.x,this._mouse.y,0);a.unproject(this.object);let l=this.object.zoom;this.object.zoom=Math.max(this.minZoom,Math.min(this.maxZoom,this.object.zoom/this._scale)),this.object.updateProjectionMatrix(),r=l!==this.object.zoom;let c=new I(this._mouse.x,this._mouse.y,0);c.unproject(this.object),this.object.position.sub(c).add(a),this.object.updateMatrixWorld(),o=We.length()}else console.warn("WARNING: OrbitControls.js encountered an unknown camera type - zoom to cursor disabled."),this.zoomToCursor=!1;o!==null&&(this.screenSpacePanning?this.target.set(0,0,-1).transformDirection(this.object.matrix).multiplyScalar(o).add(this.object.position):(Kl.origin.copy(this.object.position),Kl.direction.set(0,0,-1).transformDirection(this.object.matrix),Math.abs(this.object.up.dot(Kl.direction))<SM?this.object.lookAt(this.target):(tm.setFromNormalAndCoplanarPoint(this.object.up,this.target),Kl.intersectPlane(tm,this.target))))}else if(this.object.isOrthographicCamera){let o=this.object.zoom;this.object.zoom=Math.max(this.minZoom,Math.min(this.maxZoom,this.object.zoom/this._scale)),o!==this.object.zoom&&(this.object.updateProjectionMatrix(),r=!0)}return this._scale=1,this._performCursorZoom=!1,r||this._lastPosition.distanceToSquared(this.object.position)>wu||8*(1-this._lastQuaternion.dot(this.object.quaternion))>wu||this._lastTargetPosition.distanceToSquared(this.target)>wu?(this.dispatchEvent(Qp),this._lastPosition.copy(this.object.position),this._lastQuaternion.copy(this.object.quaternion),this._lastTargetPosition.copy(this.target),!0):!1}_getAutoRotationAngle(t){return t!==null?pn/60*this.autoRotateSpeed*t:pn/60/60*this.autoRotateSpeed}_getZoomScale(t){let e=Math.abs(t*.01);return Math.pow(.95,this.zoomSpeed*e)}_rotateLeft(t){this._sphericalDelta.theta-=t}_rotateUp(t){this._sphericalDelta.phi-=t}_panLeft(t,e){We.setFromMatrixColumn(e,0),We.multiplyScalar(-t),this._panOffset.add(We)}_panUp(t,e){this.screenSpacePanning===!0?We.setFromMatrixColumn(e,1):(We.setFromMatrixColumn(e,0),We.crossVectors(this.object.up,We)),We.multiplyScalar(t),this._panOffset.add(We)}_pan(t,e){let n=this.domElement;if(this.object.isPerspectiveCamera){let s=this.object.position;We.copy(s).sub(this.target);let r=We.length();r*=Math.tan(this.object.fov/2*Math.PI/180),this._panLeft(2*t*r/n.clientHeight,this.object.matrix),this._panUp(2*e*r/n.clientHeight,this.object.matrix)}else this.object.isOrthographicCamera?(this._panLeft(t*(this.object.right-this.object.left)/this.object.zoom/n.clientWidth,this.object.matrix),this._panUp(e*(this.object.top-this.object.bottom)/this.object.zoom/n.clientHeight,this.object.matrix)):(console.warn("WARNING: OrbitControls.js encountered an unknown camera type - pan disabled."),this.enablePan=!1)}_dollyOut(t){this.object.isPerspectiveCamera||this.object.isOrthographicCamera?this._scale/=t:(console.warn("WARNING: OrbitControls.js encountered an unknown camera type - dolly/zoom disabled."),this.enableZoom=!1)}_dollyIn(t){this.object.isPerspectiveCamera||this.object.isOrthographicCamera?this._scale*=t:(console.warn("WARNING: OrbitControls.js encountered an unknown camera type - dolly/zoom disabled."),this.enableZoom=!1)}_updateZoomParameters(t,e){if(!this.zoomToCursor)return;this._performCursorZoom=!0;let n=this.domElement.getBoundingClientRect(),s=t-n.left,r=e-n.top,o=n.width,a=n.height;this._mouse.x=s/o*2-1,this._mouse.y=-(r/a)*2+1,this._dollyDirection.set(this._mouse.x,this._mouse.y,1).unproject(this.object).sub(this.object.position).normalize()}_clampDistance(t){return Math.max(this.minDistance,Math.min(this.maxDistance,t))}_handleMouseDownRotate(t){this._rotateStart.set(t.clientX,t.clientY)}_handleMouseDownDolly(t){this._updateZoomParameters(t.clientX,t.clientY),this._dollyStart.set(t.clientX,t.clientY)}_handleMouseDownPan(t){this._panStart.set(t.clientX,t.clientY)}_handleMouseMoveRotate(t){this._rotateEnd.set(t.clientX,t.clientY),this._rotateDelta.subVectors(this._rotateEnd,this._rotateStart).multiplyScalar(this.rotateSpeed);let e=this.domElement;this._rotateLeft(pn*this._rotateDelta.x/e.clientHeight),this._rotateUp(pn*this._rotateDelta.y/e.clientHeight),this._rotateStart.copy(this._rotateEnd),this.update()}_handleMouseMoveDolly(t){this._dollyEnd.set(t.clientX,t.clientY),this._dollyDelta.subVectors(this._dollyEnd,this._dollyStart),this._dollyDelta.y>0?this._dollyOut(this._getZoomScale(this._dollyDelta.y)):this._dollyDelta.y<0&&this._dollyIn(this._getZoomScale(this._dollyDelta.y)),this._dollyStart.copy(this._dollyEnd),this.zoomToCursor&&(this._performCursorZoom=!0,this._dollyDirection.set(this._mouse.x,this._mouse.y,1).unproject(this.object).sub(this.object.position).normalize()),this.update()}_handleMouseMovePan(t){this._panEnd.set(t.clientX,t.clientY),this._panDelta.subVectors(this._panEnd,this._panStart).multiplyScalar(this.panSpeed),this._pan(this._panDelta.x,this._panDelta.y),this._panStart.copy(this._panEnd),this.update()}_handleMouseWheel(t){this._updateZoomParameters(t.clientX,t.clientY),t.deltaY<0?this._dollyIn(this._getZoomScale(t.deltaY)):t.deltaY>0&&this._dollyOut(this._getZoomScale(t.deltaY)),this.update()}_handleKeyDown(t){let e=!1;switch(t.code){case this.keys.UP:t.ctrlKey||t.metaKey||t.shiftKey?this.enableRotate&&this._rotateUp(pn*this.keyRotateSpeed/this.domElement.clientHeight):this.enablePan&&this._pan(0,this.keyPanSpeed),e=!0;break;case this.keys.BOTTOM:t.ctrlKey||t.metaKey||t.shiftKey?this.enableRotate&&this._rotateUp(-pn*this.keyRotateSpeed/this.domElement.clientHeight):this.enablePan&&this._pan(0,-this.keyPanSpeed),e=!0;break;case this.keys.LEFT:t.ctrlKey||t.metaKey||t.shiftKey?this.enableRotate&&this._rotateLeft(pn*this.keyRotateSpeed/this.domElement.clientHeight):this.enablePan&&this._pan(this.keyPanSpeed,0),e=!0;break;case this.keys.RIGHT:t.ctrlKey||t.metaKey||t.shiftKey?this.enableRotate&&this._rotateLeft(-pn*this.keyRotateSpeed/this.domElement.clientHeight):this.enablePan&&this._pan(-this.keyPanSpeed,0),e=!0;break}e&&(t.preventDefault(),this.update())}_handleTouchStartRotate(t){if(this._pointers.length===1)this._rotateStart.set(t.pageX,t.pageY);else{let e=this._getSecondPointerPosition(t),n=.5*(t.pageX+e.x),s=.5*(t.pageY+e.y);this._rotateStart.set(n,s)}}_handleTouchStartPan(t){if(this._pointers.length===1)this._panStart.set(t.pageX,t.pageY);else{let e=this._getSecondPointerPosition(t),n=.5*(t.pageX+e.x),s=.5*(t.pageY+e.y);this._panStart.set(n,s)}}_handleTouchStartDolly(t){let e=this._getSecondPointerPosition(t),n=t.pageX-e.x,s=t.pageY-e.y,r=Math.sqrt(n*n+s*s);this._dollyStart.set(0,r)}_handleTouchStartDollyPan(t){this.enableZoom&&this._handleTouchStartDolly(t),this.enablePan&&this._handleTouchStartPan(t)}_handleTouchStartDollyRotate(t){this.enableZoom&&this._handleTouchStartDolly(t),this.enableRotate&&this._handleTouchStartRotate(t)}_handleTouchMoveRotate(t){if(this._pointers.length==1)this._rotateEnd.set(t.pageX,t.pageY);else{let n=this._getSecondPointerPosition(t),s=.5*(t.pageX+n.x),r=.5*(t.pageY+n.y);this._rotateEnd.set(s,r)}this._rotateDelta.subVectors(this._rotateEnd,this._rotateStart).multiplyScalar(this.rotateSpeed);let e=this.domElement;this._rotateLeft(pn*this._rotateDelta.x/e.clientHeight),this._rotateUp(pn*this._rotateDelta.y/e.clientHeight),this._rotateStart.copy(this._rotateEnd)}_handleTouchMovePan(t){if(this._pointers.length===1)this._panEnd.set(t.pageX,t.pageY);else{let e=this._getSecondPointerPosition(t),n=.5*(t.pageX+e.x),s=.5*(t.pageY+e.y);this._panEnd.set(n,s)}this._panDelta.subVectors(this._panEnd,this._panStart).multiplyScalar(this.panSpeed),this._pan(this._panDelta.x,this._panDelta.y),this._panStart.copy(this._panEnd)}_handleTouchMoveDolly(t){let e=this._getSecondPointerPosition(t),n=t.pageX-e.x,s=t.pageY-e.y,r=Math.sqrt(n*n+s*s);this._dollyEnd.set(0,r),this._dollyDelta.set(0,Math.pow(this._dollyEnd.y/this._dollyStart.y,this.zoomSpeed)),this._dollyOut(this._dollyDelta.y),this._dollyStart.copy(this._dollyEnd);let o=(t.pageX+e.x)*.5,a=(t.pageY+e.y)*.5;this._updateZoomParameters(o,a)}_handleTouchMoveDollyPan(t){this.enableZoom&&this._handleTouchMoveDolly(t),this.enablePan&&this._handleTouchMovePan(t)}_handleTouchMoveDollyRotate(t){this.enableZoom&&this._handleTouchMoveDolly(t),this.enableRotate&&this._handleTouchMoveRotate(t)}_addPointer(t){this._pointers.push(t.pointerId)}_removePointer(t){delete this._pointerPositions[t.pointerId];for(let e=0;e<this._pointers.length;e++)if(this._pointers[e]==t.pointerId){this._pointers.splice(e,1);return}}_isTrackingPointer(t){for(let e=0;e<this._pointers.length;e++)if(this._pointers[e]==t.pointerId)return!0;return!1}_trackPointer(t){let e=this._pointerPositions[t.pointerId];e===void 0&&(e=new rt,this._pointerPositions[t.pointerId]=e),e.set(t.pageX,t.pageY)}_getSecondPointerPosition(t){let e=t.pointerId===this._pointers[0]?this._pointers[1]:this._pointers[0];return this._pointerPositions[e]}_customWheelEvent(t){let e=t.deltaMode,n={clientX:t.clientX,clientY:t.clientY,deltaY:t.deltaY};switch(e){case 1:n.deltaY*=16;break;case 2:n.deltaY*=100;break}return t.ctrlKey&&!this._controlActive&&(n.deltaY*=10),n}};function wM(i){this.enabled!==!1&&(this._pointers.length===0&&(this.domElement.setPointerCapture(i.pointerId),this.domElement.ownerDocument.addEventListener("pointermove",this._onPointerMove),this.domElement.ownerDocument.addEventListener("pointerup",this._onPointerUp)),!this._isTrackingPointer(i)&&(this._addPointer(i),i.pointerType==="touch"?this._onTouchStart(i):this._onMouseDown(i),this._cursorStyle==="grab"&&(this.domElement.style.cursor="grabbing")))}function EM(i){this.enabled!==!1&&(i.pointerType==="touch"?this._onTouchMove(i):this._onMouseMove(i))}function AM(i){switch(this._removePointer(i),this._pointers.length){case 0:this.domElement.releasePointerCapture(i.pointerId),this.domElement.ownerDocument.removeEventListener("pointermove",this._onPointerMove),this.domElement.ownerDocument.removeEventListener("pointerup",this._onPointerUp),this.dispatchEvent(em),this.state=ge.NONE,this._cursorStyle==="grab"&&(this.domElement.style.cursor="grab");break;case 1:let t=this._pointers[0],e=this._pointerPositions[t];this._onTouchStart({pointerId:t,pageX:e.x,pageY:e.y});break}}function TM(i){let t;switch(i.button){case 0:t=this.mouseButtons.LEFT;break;case 1:t=this.mouseButtons.MIDDLE;break;case 2:t=this.mouseButtons.RIGHT;break;default:t=-1}switch(t){case Vi.DOLLY:if(this.enableZoom===!1)return;this._handleMouseDownDolly(i),this.state=ge.DOLLY;break;case Vi.ROTATE:if(i.ctrlKey||i.metaKey||i.shiftKey){if(this.enablePan===!1)return;this._handleMouseDownPan(i),this.state=ge.PAN}else{if(this.enableRotate===!1)return;this._handleMouseDownRotate(i),this.state=ge.ROTATE}break;case Vi.PAN:if(i.ctrlKey||i.metaKey||i.shiftKey){if(this.enableRotate===!1)return;this._handleMouseDownRotate(i),this.state=ge.ROTATE}else{if(this.enablePan===!1)return;this._handleMouseDownPan(i),this.state=ge.PAN}break;default:this.state=ge.NONE}this.state!==ge.NONE&&this.dispatchEvent(Eu)}function CM(i){switch(this.state){case ge.ROTATE:if(this.enableRotate===!1)return;this._handleMouseMoveRotate(i);break;case ge.DOLLY:if(this.enableZoom===!1)return;this._handleMouseMoveDolly(i);break;case ge.PAN:if(this.enablePan===!1)return;this._handleMouseMovePan(i);break}}function RM(i){this.enabled===!1||this.enableZoom===!1||this.state!==ge.NONE||(i.preventDefault(),this.dispatchEvent(Eu),this._handleMouseWheel(this._customWheelEvent(i)),this.dispatchEvent(em))}function PM(i){this.enabled!==!1&&this._handleKeyDown(i)}function IM(i){switch(this._trackPointer(i),this._pointers.length){case 1:switch(this.touches.ONE){case Hi.ROTATE:if(this.enableRotate===!1){this.state=ge.NONE;break}this._handleTouchStartRotate(i),this.state=ge.TOUCH_ROTATE;break;case Hi.PAN:if(this.enablePan===!1){this.state=ge.NONE;break}this._handleTouchStartPan(i),this.state=ge.TOUCH_PAN;break;default:this.state=ge.NONE}break;case 2:switch(this.touches.TWO){case Hi.DOLLY_PAN:if(this.enableZoom===!1&&this.enablePan===!1)return;this._handleTouchStartDollyPan(i),this.state=ge.TOUCH_DOLLY_PAN;break;case Hi.DOLLY_ROTATE:if(this.enableZoom===!1&&this.enableRotate===!1)return;this._handleTouchStartDollyRotate(i),this.state=ge.TOUCH_DOLLY_ROTATE;break;default:this.state=ge.NONE}break;default:this.state=ge.NONE}this.state!==ge.NONE&&this.dispatchEvent(Eu)}function LM(i){switch(this._trackPointer(i),this.state){case ge.TOUCH_ROTATE:if(this.enableRotate===!1)return;this._handleTouchMoveRotate(i),this.update();break;case ge.TOUCH_PAN:if(this.enablePan===!1)return;this._handleTouchMovePan(i),this.update();break;case ge.TOUCH_DOLLY_PAN:if(this.enableZoom===!1&&this.enablePan===!1)return;this._handleTouchMoveDollyPan(i),this.update();break;case ge.TOUCH_DOLLY_ROTATE:if(this.enableZoom===!1&&this.enableRotate===!1)return;this._handleTouchMoveDollyRotate(i),this.update();break;default:this.state=ge.NONE}}function DM(i){this.enabled!==!1&&i.preventDefault()}function NM(i){i.key==="Control"&&(this._controlActive=!0,this.domElement.ownerDocument.addEventListener("keyup",this._interceptControlUp,{passive:!0,capture:!0}))}function UM(i){i.key==="Control"&&(this._controlActive=!1,this.domElement.ownerDocument.removeEventListener("keyup",this._interceptControlUp,{passive:!0,capture:!0}))}var nm=`
uniform highp sampler2D parts;
uniform int across;
in float part;
flat out vec4 colour;
flat out vec4 state;
out vec3 root;
out vec3 seen;

vec4 texel(int row) {
  int k = int(part + 0.5) * 4 + row;
  return texelFetch(parts, ivec2(k % across, k / across), 0);
}

void place() {
  vec4 q = texel(0);
  vec3 twice = 2.0 * cross(q.xyz, position);
  root = position + q.w * twice + cross(q.xyz, twice) + texel(1).xyz;
  colour = texel(2);
  state = texel(3);
  vec4 view = modelViewMatrix * vec4(root, 1.0);
  seen = view.xyz;
  gl_Position = projectionMatrix * view;
  if (state.x < 0.5) gl_Position = vec4(0.0, 0.0, 2.0, 1.0); // hidden: moved out of the view
}
`,Qs=`
uniform vec4 planes[3];
uniform bool cutting;
in vec3 root;
// a plane without a normal cuts nothing
bool cutAway() {
  if (cutting) for (int k = 0; k < 3; k++) if (dot(planes[k].xyz, root) > planes[k].w) return true;
  return false;
}
`,im=`${Qs}
uniform vec3 eye;
// the shares of the way from the eye to the root; without an entry the first is negative
vec2 kept(vec3 ray) {
  vec2 ends = vec2(-1.0, 1e9);
  for (int k = 0; k < 3; k++) {
    float rate = dot(planes[k].xyz, ray);
    float left = planes[k].w - dot(planes[k].xyz, eye);
    if (rate < 0.0) ends.x = max(ends.x, left / rate);
    if (rate > 0.0) ends.y = min(ends.y, left / rate);
  }
  return ends;
}
`,wn=`${nm}
void main() { place(); }
`,Au=`precision highp float;
${Qs}
uniform vec3 hatch;
uniform vec3 table;
uniform vec3 grip;
uniform vec3 picked;
uniform float opacity;
uniform bool veil;
uniform float dense;
flat in vec4 colour;
flat in vec4 state;
in vec3 seen;
out vec4 result;

float stripes(float width) {
  float t = (gl_FragCoord.x + gl_FragCoord.y) / (width * dense);
  return smoothstep(0.28, 0.34, abs(fract(t) - 0.5));
}

void main() {
  if (cutAway() || (state.w > 0.5) != veil) discard; // transparent parts have a pass of their own
  vec3 n = normalize(cross(dFdx(seen), dFdy(seen)));
  vec3 base = colour.rgb;
  if (state.y > 1.5) base = table;
  if (state.y > 0.5 && state.y < 1.5) base = mix(base, hatch, 0.6 * stripes(9.0)); // a table has a grid
  float key = max(dot(n, normalize(vec3(-0.35, 0.75, 0.55))), 0.0);
  float fill = max(dot(n, normalize(vec3(0.8, 0.1, 0.5))), 0.0);
  vec3 lit = min(base * (0.68 + 0.36 * key + 0.14 * fill), vec3(1.0));
  float marks = mod(state.z, 8.0);
  if (marks > 3.5) lit = mix(lit, grip, 0.18 + 0.62 * stripes(9.0));
  if (state.z > 7.5) lit = mix(lit, picked, 0.22);
  if (mod(marks, 2.0) > 0.5) lit = mix(lit, picked, 0.25 + 0.6 * stripes(7.0));
  result = vec4(lit, veil ? opacity : 1.0);
}
`,sm=`precision highp float;
${im}
uniform highp mat4 projectionMatrix;
uniform highp mat4 modelViewMatrix;
uniform float dense;
flat in vec4 colour;
flat in vec4 state;
in vec3 seen;
out vec4 result;
void main() {
  vec3 ray = root - eye;
  vec2 ends = kept(ray);
  float t = ends.x;
  if (t <= 0.0 || t >= 1.0 || t >= ends.y) discard;
  vec4 at = projectionMatrix * modelViewMatrix * vec4(eye + t * ray, 1.0);
  float depth = 0.5 + 0.5 * at.z / at.w;
  gl_FragDepth = mix(depth, gl_FragCoord.z, 0.5);
  float stripe = smoothstep(0.36, 0.42, abs(fract((gl_FragCoord.x - gl_FragCoord.y) / (8.0 * dense)) - 0.5));
  result = vec4(colour.rgb * mix(0.92, 0.66, stripe), 1.0);
}
`,Tu=`precision highp float;
${im}
out vec4 result;
void main() {
  if (kept(root - eye).x >= 1.0) discard; // before the line of sight enters
  result = vec4(0.0);
}
`,rm=`precision highp float;
${Qs}
uniform vec3 ink;
uniform vec3 accent;
uniform vec3 grip;
uniform float strength;
flat in vec4 state;
out vec4 result;
void main() {
  if (cutAway()) discard;
  float marks = mod(state.z, 8.0);
  bool gripped = marks > 3.5;
  bool moves = marks > 1.5 && !gripped;
  result = vec4(gripped ? grip : moves ? accent : ink, gripped || moves ? 1.0 : strength * (state.w > 0.5 ? 0.5 : 1.0));
}
`,tc=`precision highp float;
${Qs}
uniform vec3 ink;
uniform float strength;
out vec4 result;
void main() {
  if (cutAway()) discard;
  result = vec4(ink, strength);
}
`,om=`${nm}
uniform float dense;
void main() { place(); gl_PointSize = 7.0 * dense; }
`,am=`precision highp float;
${Qs}
uniform vec3 ink;
uniform float strength;
out vec4 result;
void main() {
  if (cutAway() || length(gl_PointCoord - 0.5) > 0.5) discard;
  result = vec4(ink, strength);
}
`,lm=`precision highp float;
${Qs}
uniform float count;
flat in vec4 colour;
flat in vec4 state;
out vec4 result;
void main() {
  if (cutAway()) discard;
  int k = int(colour.a + 0.5);
  result = vec4(float(k & 255), float((k >> 8) & 255), float((k >> 16) & 255), 255.0) / 255.0;
}
`,cm=`
in float tint;
out vec3 seen;
flat out float share;
void main() {
  share = tint;
  vec4 view = modelViewMatrix * instanceMatrix * vec4(position, 1.0);
  seen = view.xyz;
  gl_Position = projectionMatrix * view;
}
`,hm=`precision highp float;
uniform vec3 ink;
uniform vec3 full;
uniform bool plain;
in vec3 seen;
flat in float share;
out vec4 result;
void main() {
  vec3 n = normalize(cross(dFdx(seen), dFdy(seen)));
  float key = max(dot(n, normalize(vec3(-0.35, 0.75, 0.55))), 0.0);
  result = vec4(plain ? ink : mix(ink, full, share) * (0.8 + 0.3 * key), 1.0);
}
`,um=`precision highp float;
uniform vec3 up;
uniform float base;
uniform float range;
flat in vec4 colour;
flat in vec4 state;
in vec3 root;
out vec4 result;
void main() {
  if (state.y > 1.5) discard;
  float near = 1.0 - clamp((dot(up, root) - base) / range, 0.0, 1.0);
  result = vec4(near * near, 0.0, 0.0, 1.0);
}
`;var wi=8,OM=new I(0,1,0);function Cu(i){let[t,e]=[[],[]];for(let[n,s]of i)for(let r=0;r<wi;r+=1){let o=2*Math.PI*r/wi;t.push(n*Math.cos(o),s,n*Math.sin(o))}for(let n=0;n+1<i.length;n+=1)for(let s=0;s<wi;s+=1){let[r,o]=[n*wi+s,n*wi+(s+1)%wi];e.push(r,r+wi,o,o,r+wi,o+wi)}return fm(t,e)}function fm(i,t){let e=new Se;return e.setAttribute("position",new Ce(new Float32Array(i),3)),e.setIndex(t),e}var FM=()=>Cu([[0,0],[.035,0],[.035,.7],[.1,.7],[0,1]]),BM=()=>Cu([[0,0],[.05,0],[.05,1],[0,1]]),kM=()=>Cu(Array.from({length:9},(i,t)=>[Math.sin(Math.PI*t/8),-Math.cos(Math.PI*t/8)]));function zM(){let[i,t]=[[],[]],e=28,n=Array.from({length:e+1},(r,o)=>[1.5*Math.PI*o/e,.045]),s=1.5*Math.PI;n.push([s,.13],[s+.36,0]);for(let[r,o]of n)for(let a=0;a<6;a+=1){let l=Math.PI*a/3,c=1+o*Math.cos(l);i.push(c*Math.sin(r),o*Math.sin(l),c*Math.cos(r))}for(let r=0;r+1<n.length;r+=1)for(let o=0;o<6;o+=1){let[a,l]=[r*6+o,r*6+(o+1)%6];t.push(a,a+6,l,l,a+6,l+6)}return fm(i,t)}var Vn=class{constructor(){this.material=dm(!1),this.halo=dm(!0),this.group=new De,this.shapes={straight:FM(),round:zM(),ball:kM(),rod:BM()}}set(t){for(let e of[...this.group.children])this.group.remove(e),e.geometry.dispose(),e.dispose();for(let[e,n]of Object.entries(t))if(n.length)for(let[s,r]of[[this.halo,1.3],[this.material,1]]){if(s===this.halo&&n.length>150)continue;let o=new Nr(GM(this.shapes[e],n),s,n.length);o.frustumCulled=!1,n.forEach((a,l)=>o.setMatrixAt(l,VM(a,e,r))),this.group.add(o)}}theme(t,e,n=t){this.material.uniforms.ink.value.set(t),this.material.uniforms.full.value.set(n),this.halo.uniforms.ink.value.set(e)}};function GM(i,t){let e=new Se;e.setAttribute("position",i.getAttribute("position")),e.setIndex(i.getIndex());let n=new Float32Array(t.map(s=>Math.min(1,s.tint||0)));return e.setAttribute("tint",new ss(n,1)),e}var dm=i=>new Je({glslVersion:Gn,vertexShader:cm,fragmentShader:hm,uniforms:{ink:{value:new Yt},full:{value:new Yt},plain:{value:i}},side:i?Ge:bn});function VM({at:i,along:t,size:e,wide:n},s,r){let o=new I(...t).normalize(),a=new Ue().setFromUnitVectors(OM,o),l=(n||e)*r,c=r>1?e+.02*l:e,h={straight:[l,c,l],rod:[l,c,l],round:[e,e*r,e],ball:[e*r,e*r,e*r]};return new ue().compose(new I(...i),a,new I(...h[s]))}var HM=.35,ec=class{constructor(){this.faces=new Ee(new Se,new vi({polygonOffset:!0,polygonOffsetFactor:1,polygonOffsetUnits:1})),this.edges=new Rn(new Se,new Kn),this.group=new De,this.group.add(this.faces,this.edges),this.group.visible=!1}set({positions:t,triangles:e,edges:n},s,r=!1){Object.assign(this.faces.material,{transparent:r,opacity:r?HM:1,depthWrite:!r}),Object.assign(this.edges.material,{transparent:r,depthTest:!r});for(let{material:a}of[this.faces,this.edges])a.needsUpdate=!0;let o=new Ce(new Float32Array(t),3);for(let[a,l]of[[this.faces,e],[this.edges,n]])a.geometry.setAttribute("position",o),a.geometry.setIndex(new Ce(Uint32Array.from(l),1));this.group.position.set(...s)}theme(t){this.faces.material.color.set(t("picked")),this.edges.material.color.set(t("edge"))}};var Ru=3.2,pm=256,WM=.002,XM=5,po=class{constructor(t,e){let{radius:n}=t;this.parts=e,this.up=Ct(me(t.given.down),-1),this.height=qM(t,this.up),this.reach=1.35*n;let s=()=>new Ze(pm,pm,{minFilter:Ye,magFilter:Ye,depthBuffer:!1});[this.sharp,this.soft]=[s(),s()];let r=new Je({glslVersion:Gn,vertexShader:JM,fragmentShader:jM,uniforms:{shade:{value:this.sharp.texture}},depthTest:!1,depthWrite:!1});this.blur=new Ee(new Bi(2,2),r),this.blur.frustumCulled=!1,this.step=$M(2*n/XM),this.material=new Je({glslVersion:Gn,vertexShader:YM,fragmentShader:ZM,transparent:!0,depthWrite:!1,uniforms:{shade:{value:this.soft.texture},reach:{value:this.reach},step:{value:this.step},side:{value:Ru*n},ink:{value:new Yt}}}),this.throwing=new Je({glslVersion:Gn,vertexShader:wn,fragmentShader:um,uniforms:{...e.shared,up:{value:new I(...this.up)},base:{value:this.height},range:{value:n}},depthTest:!1,depthWrite:!1,transparent:!0,blending:il,blendEquation:sl,blendSrc:eo,blendDst:eo}),this.mesh=new Ee(new Bi(2*Ru*n,2*Ru*n),this.material),this.mesh.quaternion.copy(new Ue().setFromUnitVectors(new I(0,0,1),new I(...this.up))),this.mesh.position.set(...Ct(this.up,this.height+WM*n)),this.planar=t.planar,this.mesh.renderOrder=-4,this.camera=new Xs(-this.reach,this.reach,this.reach,-this.reach,-8*n,8*n),this.drawn=-1}shade(t,e){let{parts:n}=this;if(this.mesh.visible=!e&&!this.planar,!this.mesh.visible||this.drawn===n.texture.version)return;this.drawn=n.texture.version;let{material:s}=n.faces,{matrixWorld:r,parent:o}=n.faces;this.camera.quaternion.copy(this.mesh.quaternion),this.camera.position.set(0,0,0),this.camera.updateMatrixWorld();let a=t.getRenderTarget(),l=r.clone();r.identity(),n.faces.matrixWorldAutoUpdate=!1,n.faces.material=this.throwing,n.faces.parent=null,t.setRenderTarget(this.sharp),t.clear(),t.render(n.faces,this.camera),t.setRenderTarget(this.soft),t.render(this.blur,this.camera),t.setRenderTarget(a),n.faces.parent=o,n.faces.material=s,n.faces.matrixWorldAutoUpdate=!0,r.copy(l)}theme(t){this.material.uniforms.ink.value.set(t("ink"))}dispose(){for(let t of[this.sharp,this.soft,this.material,this.blur.material,this.blur.geometry])t.dispose();this.throwing.dispose(),this.mesh.geometry.dispose()}};function qM({parts:i,shapes:t,extent:e},n){let s=1/0;return i.shape.forEach((r,o)=>{if(i.table?.[o])return;let[a,l,c,h]=i.rotation.subarray(4*o,4*o+4),u=new Ue(l,c,h,a).invert(),d=new I(...n).applyQuaternion(u),f=n.reduce((x,p,g)=>x+p*i.position[3*o+g],0),{positions:m}=t[r];for(let x=0;x<m.length;x+=3){let p=f+d.x*m[x]+d.y*m[x+1]+d.z*m[x+2];p<s&&(s=p)}}),Number.isFinite(s)?s:-Math.hypot(...e)}function $M(i){let t=10**Math.floor(Math.log10(i));return t*([5,2,1].find(e=>e*t<=i)??1)}var YM=`
out vec2 at;
void main() {
  at = position.xy;
  gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0);
}
`,ZM=`precision highp float;
uniform sampler2D shade;
uniform float reach;
uniform float step;
uniform float side;
uniform vec3 ink;
in vec2 at;
out vec4 result;

float line(vec2 p, float every) {
  vec2 q = abs(fract(p / every - 0.5) - 0.5) / fwidth(p / every);
  return 1.0 - min(min(q.x, q.y), 1.0);
}

void main() {
  float fade = 1.0 - smoothstep(0.35, 0.95, length(at) / side);
  if (fade <= 0.0) discard;
  float grid = max(0.16 * line(at, step), 0.3 * line(at, 5.0 * step)) * fade;
  vec2 uv = 0.5 + 0.5 * at / reach;
  bool inside = all(greaterThan(uv, vec2(0.0))) && all(lessThan(uv, vec2(1.0)));
  float dark = inside ? 0.42 * texture(shade, uv).r : 0.0;
  // the shadow darkens, the lines have the colour of the ink
  result = vec4(ink * grid / max(grid + dark, 1e-4), min(0.75, grid + dark));
}
`,JM=`
out vec2 spot;
void main() {
  spot = 0.5 + 0.5 * position.xy;
  gl_Position = vec4(position.xy, 0.0, 1.0);
}
`,jM=`precision highp float;
uniform sampler2D shade;
in vec2 spot;
out vec4 result;
void main() {
  float dark = 0.0;
  float whole = 0.0;
  for (int i = -3; i <= 3; i++) {
    for (int j = -3; j <= 3; j++) {
      float weight = exp(-0.16 * float(i * i + j * j));
      dark += weight * texture(shade, spot + vec2(float(i), float(j)) * 0.011).r;
      whole += weight;
    }
  }
  result = vec4(dark / whole, 0.0, 0.0, 1.0);
}
`;var nc=1024,KM=8,mo=class{constructor(t){this.page=t,this.count=t.parts.names.length;let e=Math.ceil(this.count*4/nc);this.data=new Float32Array(4*nc*e),this.texture=new is(this.data,nc,e,Sn,fn),this.texture.minFilter=Ne,this.texture.magFilter=Ne,this.shared={parts:{value:this.texture},across:{value:nc},planes:{value:[0,1,2].map(()=>new Te(0,0,0,1))},cutting:{value:!1},dense:{value:1},accent:{value:new Yt},grip:{value:new Yt}},this.visible=new Uint8Array(this.count).fill(1),this.present=new Uint8Array(this.count).fill(1),this.gripped=new Uint8Array(this.count),this.moving=new Uint8Array(this.count),this.selected=new Set,this.hovered=-1,this.group=new De,this.makeMaterials();let[n,s]=QM(t);this.faces=new Ee(n,this.material.face),this.veil=new Ee(n,this.material.veil),this.veil.visible=!1,this.edges=new Rn(s,this.material.edge),this.patches=eS(t,this.material),this.cut=new De,["back","front","cap"].forEach((r,o)=>{let a=new Ee(n,this.material[r]);a.renderOrder=o-3,this.cut.add(a)}),this.cut.visible=!1,this.veil.renderOrder=1,this.edges.renderOrder=2,this.group.add(this.faces,this.veil,this.edges,this.patches,this.cut);for(let r of[this.faces,this.veil,this.edges,...this.patches.children,...this.cut.children])r.frustumCulled=!1;this.paint(t.parts.colour);for(let r=0;r<this.count;r+=1)this.put(r,2,3,r),this.put(r,3,1,t.parts.table?.[r]?2:t.parts.grounded[r]);this.pose(null,0,0),this.states()}makeMaterials(){let t=(a,l,c,h={})=>new Je({glslVersion:Gn,vertexShader:a,fragmentShader:l,uniforms:{...this.shared,...c},...h}),e=()=>({value:new Yt}),n={transparent:!0,depthWrite:!1,depthTest:!1},s={hatch:e(),table:e(),picked:e(),opacity:{value:1}},r={eye:{value:new I}},o={polygonOffset:!0,polygonOffsetFactor:1,polygonOffsetUnits:1};this.material={face:t(wn,Au,{...s,veil:{value:!1}},o),veil:t(wn,Au,{...s,veil:{value:!0}},{...o,transparent:!0,depthWrite:!1}),edge:t(wn,rm,{ink:e(),strength:{value:.75}},{transparent:!0,depthWrite:!1}),patch:t(wn,tc,{ink:e(),strength:{value:.4}},{...n,depthTest:!0,side:rn}),through:t(wn,tc,{ink:e(),strength:{value:.16}},{...n,side:rn}),rim:t(wn,tc,{ink:e(),strength:{value:.85}},n),spot:t(om,am,{ink:e(),strength:{value:.95}},n),number:t(wn,lm,{}),back:t(wn,Tu,r,mm(Ge,Kh)),front:t(wn,Tu,r,mm(bn,Qh)),cap:t(wn,sm,r,{side:Ge,stencilWrite:!0,stencilFunc:tu,stencilRef:0,stencilZPass:Ls})}}put(t,e,n,s){this.data[4*(4*t+e)+n]=s}paint(t){for(let e=0;e<this.count;e+=1)for(let n=0;n<3;n+=1)this.put(e,2,n,t[3*e+n]/255);this.texture.needsUpdate=!0}pose(t,e,n){for(let s=0;s<this.count;s+=1){let[r,o]=Do(this.page.parts,s,t,e,n),a=16*s;this.data.set(r,a),this.data.set(o,a+4)}this.texture.needsUpdate=!0}carry(t,e){for(let n=0;n<this.count;n+=1){let[s,r]=md(this.page.parts,n,t[n],e[n]),o=16*n;this.data.set(s,o),this.data.set(r,o+4)}this.texture.needsUpdate=!0}shown(t){return!!(this.visible[t]&&this.present[t])}seen(t,e){let{cutting:n,planes:s}=this.shared,r=({x:o,y:a,z:l,w:c})=>o*e[0]+a*e[1]+l*e[2]>c;return this.shown(t)&&!(n.value&&s.value.some(r))}states(){for(let t=0;t<this.count;t+=1){this.put(t,3,0,this.shown(t)?1:0);let e=this.moving[t]?2:this.gripped[t]?4:0;this.put(t,3,2,(this.selected.has(t)?1:0)+e+(t===this.hovered?8:0));let n=this.sparing&&(this.moving[t]||this.selected.has(t));this.put(t,3,3,this.veil.visible&&!n?1:0)}this.texture.needsUpdate=!0}centre(t){let e=this.page.parts.center.subarray(3*t,3*t+3);return this.carried(t,dr(this.page.parts,t,e))}placeOf(t,e){return e?this.carried(t,dr(this.page.parts,t,e)):this.centre(t)}inside(t,e,n=!1){let s=16*t,[r,o,a,l]=this.data.subarray(s,s+4),c=n?[0,0,0]:this.data.subarray(s+4,s+7);return oi([-r,-o,-a,l],[0,1,2].map(h=>e[h]-c[h]))}carried(t,e){let n=16*t,[s,r,o,a]=this.data.subarray(n,n+4),[l,c,h]=this.data.subarray(n+4,n+7),u=2*(r*e[2]-o*e[1]),d=2*(o*e[0]-s*e[2]),f=2*(s*e[1]-r*e[0]);return[e[0]+a*u+r*f-o*d+l,e[1]+a*d+o*u-s*f+c,e[2]+a*f+s*d-r*u+h]}get anyFaint(){return this.veil.visible}section(t){let e=t.length>0;this.shared.cutting.value=e,this.cut.visible=e,this.material.number.side=e?rn:bn,this.material.patch.visible=!e,this.material.through.visible=!e,this.shared.planes.value.forEach((n,s)=>s<t.length?n.set(...t[s][0],t[s][1]):n.set(0,0,0,1))}seeThrough(t,e=!1){this.material.face.uniforms.opacity.value=1-t,this.veil.visible=t>0,this.sparing=e,this.states()}rest(t,e){let{rotation:n,position:s}=this.page.parts,[r,o,a,l]=n.subarray(4*t,4*t+4);return oi([o,a,l,r],e).map((c,h)=>c+s[3*t+h])}dispose(){this.texture.dispose();for(let t of[this.faces,this.edges,...this.patches.children])t.geometry.dispose();for(let t of Object.values(this.material))t.dispose()}theme(t){let e=(n,s)=>n.value.set(t(s));e(this.shared.accent,"unstable"),e(this.shared.grip,"grip");for(let n of["hatch","picked"])e(this.material.face.uniforms[n],n);e(this.material.face.uniforms.table,"stage-floor"),e(this.material.edge.uniforms.ink,"edge");for(let n of["patch","through","rim","spot"])e(this.material[n].uniforms.ink,"patch")}},mm=(i,t)=>({side:i,colorWrite:!1,depthTest:!1,depthWrite:!1,stencilWrite:!0,stencilFunc:Xl,stencilZPass:t});function QM(i){let{shape:t}=i.parts,e={vertex:0,triangle:0,edge:0};for(let u of t)e.vertex+=i.shapes[u].positions.length,e.triangle+=i.shapes[u].triangles.length,e.edge+=i.shapes[u].edges.length;let n=new Float32Array(e.vertex),s=new Float32Array(e.vertex/3),r=new Uint32Array(e.triangle),o=new Uint32Array(e.edge),[a,l,c]=[0,0,0];t.forEach((u,d)=>{let f=i.shapes[u];n.set(f.positions,a),s.fill(d,a/3,(a+f.positions.length)/3);for(let m=0;m<f.triangles.length;m+=1)r[l+m]=f.triangles[m]+a/3;for(let m=0;m<f.edges.length;m+=1)o[c+m]=f.edges[m]+a/3;a+=f.positions.length,l+=f.triangles.length,c+=f.edges.length});let h={position:new Ce(n,3),part:new Ce(s,1)};return[r,o].map(u=>ic(h,u))}function ic(i,t){let e=new Se;for(let[n,s]of Object.entries(i))e.setAttribute(n,s);return t&&e.setIndex(new Ce(t,1)),e}function tS(i,t,e,n,s,r){let{parts:o,round:a}=i.patches,l=n.length;a.patch.forEach((c,h)=>{let u=o[2*c+t];e.push(...dr(i.parts,u,a.points.subarray(3*h,3*h+3))),n.push(u)});for(let c of a.triangles)s.push(l+c);for(let c of a.lines)r.push(l+c)}function eS(i,t){let{start:e,points:n,parts:s,kinds:r,kind:o}=i.patches,[a,l,c,h,u]=[[],[],[],[],[]],d=new Set(i.patches.round.patch);for(let g of[0,1])tS(i,g,a,l,c,h);for(let g=0;g+1<e.length;g+=1){if(d.has(g))continue;let y=e[g+1]-e[g],w=y>2&&["plane","given"].includes(r[o[g]]);for(let S of[s[2*g],s[2*g+1]]){let T=l.length;for(let A=e[g];A<e[g+1];A+=1)a.push(...dr(i.parts,S,n.subarray(3*A,3*A+3))),l.push(S);for(let A=0;A<y;A+=1)(w||y===2&&A===0)&&h.push(T+A,T+(A+1)%y),!w&&y!==2&&u.push(T+A),w&&A>1&&c.push(T,T+A-1,T+A)}}let f={position:new Ce(new Float32Array(a),3),part:new Ce(new Float32Array(l),1)},m=new De,x=ic(f,new Uint32Array(c)),p=e.length-1<=KM;return p&&m.add(new Ee(x,t.through)),t.rim.depthTest=!p,m.add(new Ee(x,t.patch),new Rn(ic(f,new Uint32Array(h)),t.rim),new Ur(ic(f,new Uint32Array(u)),t.spot)),m.children.forEach((g,y)=>g.renderOrder=5+y),m}var Pu={stands:"stable-fill",falls:"unstable-fill",open:"undecided-fill"},gm={stands:"stable",falls:"unstable",open:"open"},nS=.002,sc=class{constructor(){this.group=new De,this.group.visible=!1,this.areas=new De,this.colours={},this.materials=Object.fromEntries(Object.keys(Pu).map(t=>[t,new vi({side:rn,transparent:!0,opacity:.75})])),this.part=new Ee(new Se,new vi({transparent:!0,opacity:.6})),this.edges=new Rn(new Se,new Kn),this.part.add(this.edges),this.part.visible=!1,this.group.add(this.areas,this.part),this.caster=new Kr}set(t,e,n,s){this.clear(),Object.assign(this,{data:e,center:n});let r=nS*s;for(let a of t)for(let l of Object.keys(Pu))for(let c of a[l]){let h=new Ee(new Zr(_m(c)),this.materials[l]);h.position.set(-n[0],-n[1],a.height-e.below-n[2]+r),this.areas.add(h)}let o=new Yr(_m([e.footprint]),{depth:e.below+e.above,bevelEnabled:!1});o.translate(0,0,-e.below),this.part.geometry=o,this.edges.geometry=new kr(o),this.group.visible=!0}clear(){this.areas.children.forEach(({geometry:t})=>t.dispose()),this.areas.clear(),this.data=null,this.part.visible=!1,this.group.visible=!1}under(t,e,n){if(!this.group.visible)return null;this.caster.setFromCamera(new rt(t,e),n);let[s]=this.caster.intersectObjects(this.areas.children);if(!s)return null;let r=this.group.parent.worldToLocal(s.point.clone());return[r.x+this.center[0],r.y+this.center[1]]}move(t,e){if(this.part.visible=!!(t&&e),!this.part.visible)return;let[n,s,r]=this.center;this.part.position.set(t[0]-n,t[1]-s,e.height-r),this.part.material.color.set(this.colours[gm[e.state]])}theme(t){for(let[e,n]of Object.entries(Pu))this.materials[e].color.set(t(n));for(let e of Object.values(gm))this.colours[e]=t(e);this.edges.material.color.set(t("edge"))}};function _m([i,...t]){let e=s=>s.map(([r,o])=>new rt(r,o)),n=new Fi(e(i));return n.holes=t.map(s=>new Fi(e(s))),n}function go(i,t,e){let n=Math.abs(i[1])>.9?[0,0,1]:[0,-1,0],s=me(Dn(n,i)),r=ce(i,s),o=Xt(Ct(s,Math.cos(t)),Ct(r,Math.sin(t))),a=Xt(Ct(o,Math.cos(e)),Ct(i,Math.sin(e))),l=me(ce(i,o));return{front:a,right:l,up:ce(a,l)}}var rc=(i,t)=>[Lt(t,i.right),Lt(t,i.up),Lt(t,i.front)];function xm(i,t,e){let n=Math.hypot(t,e),[s,r]=n<=1?[n,Math.sqrt(Math.max(0,1-n*n))]:[Math.cos(Math.PI/2*Math.min(n-1,1)),-Math.sin(Math.PI/2*Math.min(n-1,1))],o=n>0?Xt(Ct(i.right,t/n),Ct(i.up,e/n)):[0,0,0];return me(Xt(Ct(o,s),Ct(i.front,r)))}function vm(i){let t=[i[0],0,i[2]];return Ht(t)>1e-9?me(t):[0,0,-1]}function ym(i,t){let{front:e,right:n}=go(i,0,0),s=Math.atan2(Lt(t,n),Lt(t,e)),r=Math.asin(Math.max(-1,Math.min(1,Lt(t,i))));return[s,.7*r]}var bm=30,iS=.8,sS=55,Iu=.88,rS=new I(0,-1,0);se.enabled=!1;var oc=class{constructor(t,e){this.canvas=t,this.page=e,this.renderer=new Zl({canvas:t,antialias:!0,alpha:!0,stencil:!0}),this.renderer.outputColorSpace=ns,this.renderer.setClearColor(new Yt(0),0),this.camera=new sn(bm,1,1,2),this.controls=new Ql(this.camera,t),this.controls.addEventListener("change",()=>this.draw()),this.scene=new Gs,this.root=new De,this.parts=new mo(e),this.motion=new Vn,this.forces=new Vn,this.loads=new Vn,this.open=new Vn,this.hands=new Vn,this.gauge=new Vn,this.straps=new Vn,this.hinges=new Vn,this.lines=new Rn(new Se,new Kn),this.lines.frustumCulled=!1,this.lines.visible=!1,this.ghost=new ec,this.places=new sc,this.ground=new po(e,this.parts),this.root.add(this.parts.group,this.ground.mesh,this.lines,this.ghost.group,this.places.group),this.scene.add(this.root),this.over=new Gs,this.overRoot=new De;for(let n of[this.motion,this.forces,this.loads,this.open,this.hands,this.gauge,this.straps,this.hinges])this.overRoot.add(n.group);this.over.add(this.overRoot),this.renderer.autoClear=!1,this.target=new Ze(1,1),this.drawn=()=>{},this.begun=()=>{},this.isPlain=!1,this.last=-1e9,this.pace=20,this.opening=e.planar?[1.35,.25]:[1.22,.55],this.extent=e.extent,this.upright=Mm(e.given.down),this.root.quaternion.copy(this.upright),this.home(),new ResizeObserver(()=>this.fit()).observe(t.parentElement),this.fit()}home(){this.controls.target.set(0,0,0),this.frame(this.camera),this.controls.update(),this.draw()}get halfAngle(){return this.camera.fov*Math.PI/360}flatten(t){let e=Math.tan(this.halfAngle);this.camera.fov=t?iS:bm;let{target:n}=this.controls,s=this.camera.position.clone().sub(n).multiplyScalar(e/Math.tan(this.halfAngle));this.camera.position.copy(n).add(s),this.controls.update(),this.draw()}clip(t){let{radius:e}=this.page,n=t.position.length();t.near=Math.max(e/50,n-30*e),t.far=n+60*e,t.updateProjectionMatrix()}frame(t,e=Iu){this.aim(t,new Qn(1,...this.opening),e)}aim(t,e,n=Iu){t.position.setFromSpherical(e),t.lookAt(0,0,0),t.position.setLength(this.reach(t,n))}view(t){let e=r=>new I(...r).applyQuaternion(this.root.quaternion),n=new Qn().setFromVector3(e(t).normalize()),s=e([1,0,0]);Math.sin(n.phi)<.001&&(n.theta=Math.hypot(s.x,s.z)>.001?Math.atan2(-s.z,s.x):0),n.phi=Math.max(1e-4,Math.min(Math.PI-1e-4,n.phi)),this.controls.target.set(0,0,0),this.aim(this.camera,n),this.controls.update(),this.draw()}zoomTo(t,e=0){let{parts:n}=this,s=this.page.parts.radius,r=t.map(h=>n.centre(h)),o=[0,1,2].map(h=>r.reduce((u,d)=>u+d[h],0)/r.length),a=t.reduce((h,u,d)=>Math.max(h,s[u]+Math.hypot(...r[d].map((f,m)=>f-o[m]))),e),l=this.camera.position.clone().sub(this.controls.target),c=new I(...o).applyQuaternion(this.root.quaternion);l.setLength(1.9*a/Math.sin(this.halfAngle)/Math.min(1,this.camera.aspect)),this.controls.target.copy(c),this.camera.position.copy(c).add(l),this.controls.update(),this.draw()}axes(){let t=this.camera.quaternion.clone().invert().multiply(this.root.quaternion);return[[1,0,0],[0,1,0],[0,0,1]].map(e=>new I(...e).applyQuaternion(t).toArray())}replace(t){let e=this.page.center&&t.center?t.center.map((r,o)=>this.page.center[o]-r):[0,0,0],n=this.parts;this.page=t,this.parts=new mo(t),this.root.remove(n.group,this.ground.mesh),this.ground.dispose(),this.ground=new po(t,this.parts),this.root.add(this.parts.group,this.ground.mesh),this.parts.edges.visible=!this.isPlain,this.parts.shared.dense.value=n.shared.dense.value,n.dispose(),this.extent=t.extent;let s=new I(...e).applyQuaternion(this.root.quaternion);this.controls.target.add(s),this.camera.position.add(s),this.upright=Mm(t.given.down),this.controls.update()}reach(t,e=Iu){let n=Math.tan(this.halfAngle),s=t.quaternion.clone().invert(),r=e*Math.hypot(...this.extent)/Math.sin(this.halfAngle);for(let o=0;o<8;o+=1){let a=new I(...this.extent.map((c,h)=>o>>h&1?c:-c));a.applyQuaternion(this.root.quaternion).applyQuaternion(s);let l=Math.abs(a.x)/(n*(t.aspect||1));r=Math.max(r,a.z+1.1*Math.max(l,Math.abs(a.y)/n))}return r}refit(t){let e=this.reach(this.camera);t();let{target:n}=this.controls,s=this.camera.position.clone().sub(n);this.camera.position.copy(s.multiplyScalar(this.reach(this.camera)/e).add(n)),this.controls.update(),this.draw()}spread(t){this.refit(()=>this.extent=t)}fit(){let{clientWidth:t,clientHeight:e}=this.canvas.parentElement;if(!t||!e)return;let n=!this.size;if(!n&&this.size[0]===t&&this.size[1]===e)return;let s=!n&&this.size[0]<this.size[1]!=t<e;this.size=[t,e],this.sharpen();let r=()=>{this.camera.aspect=t/e,this.camera.updateProjectionMatrix()};s?this.refit(r):r(),n&&(this.home(),this.begun()),this.draw()}turnTo(t,e=!1){this.refit(()=>{e&&this.root.quaternion.copy(this.upright);let n=new I(...t).applyQuaternion(this.root.quaternion).normalize(),s=new Ue().setFromUnitVectors(n,rS);this.root.quaternion.premultiply(s).normalize()})}orbit(t,e,n=1){let s=this.camera.position.clone().sub(this.controls.target),r=new Qn().setFromVector3(s);r.theta+=t,r.phi=Math.max(.02,Math.min(Math.PI-.02,r.phi+e)),r.radius*=n,this.camera.position.setFromSpherical(r).add(this.controls.target),this.controls.update(),this.draw()}pick(t,e){let{camera:n}=this,[s,r]=this.size,o=this.renderer.getPixelRatio();n.setViewOffset(s*o,r*o,t*o,e*o,1,1);let[a]=this.numbers(1,1);return n.clearViewOffset(),a-1}shapeOf(t){return this.page.shapes[this.page.parts.shape[t]]}hit(t,e){let n=this.pick(t,e);if(n<0)return null;let[s,r]=this.size,o=new I(2*t/s-1,1-2*e/r,.5).unproject(this.camera);this.root.updateMatrixWorld();let a=this.root.worldToLocal(this.camera.position.clone()).toArray(),c=this.root.worldToLocal(o).toArray().map((f,m)=>f-a[m]),{parts:h}=this,u=f=>h.seen(n,h.carried(n,f)),d=Wd(this.shapeOf(n),h.inside(n,a),h.inside(n,c,!0),u);return d&&{part:n,local:d.point,normal:d.normal}}within([t,e,n,s]){let{cells:o,width:a,height:l}=this.numbered(3),c=new Set,[h,u]=[Math.max(0,Math.floor(t/3)),Math.min(a-1,Math.floor(n/3))];for(let d=Math.max(0,Math.floor(e/3));d<=Math.min(l-1,s/3);d+=1)for(let f=h;f<=u;f+=1)o[d*a+f]&&c.add(o[d*a+f]-1);return[...c]}counted(t,e=5){let{parts:n}=this,{present:s}=n;n.present=s.map((a,l)=>a&&t(l)?1:0),n.states();let{cells:r}=this.numbered(e);n.present=s,n.states();let o=new Uint32Array(n.count);for(let a of r)a&&(o[a-1]+=1);return o}numbered(t){let[e,n]=this.size.map(o=>Math.max(1,Math.floor(o/t)));this.scene.updateMatrixWorld();let s=this.numbers(e,n),r=new Uint32Array(e*n);for(let o=0;o<n;o+=1){let a=(n-1-o)*e;r.set(s.subarray(a,a+e),o*e)}return{cells:r,width:e,height:n}}numbers(t,e){let{renderer:n,camera:s,parts:r}=this,o=[this.ground.mesh,r.veil,r.edges,r.patches,r.cut,this.lines,this.ghost.group,this.places.group],a=o.map(c=>c.visible);o.forEach(c=>c.visible=!1),this.clip(s),r.faces.material=r.material.number,this.target.setSize(t,e),n.setRenderTarget(this.target),n.clear(),n.render(this.scene,s);let l=new Uint8Array(4*t*e);return n.readRenderTargetPixels(this.target,0,0,t,e,l),n.setRenderTarget(null),r.faces.material=r.material.face,o.forEach((c,h)=>c.visible=a[h]),Uint32Array.from({length:t*e},(c,h)=>l[4*h+3]?1+l[4*h]+256*(l[4*h+1]+256*l[4*h+2]):0)}onScreen(t){let e=new I(...t).applyMatrix4(this.root.matrixWorld).project(this.camera);return e.z>1?null:[(e.x+1)/2*this.size[0],(1-e.y)/2*this.size[1]]}sizeOnScreen(t){let e=new I(...this.parts.centre(t)).applyMatrix4(this.root.matrixWorld).distanceTo(this.camera.position);return this.page.parts.radius[t]/e/Math.tan(this.halfAngle)*(this.size[1]/2)}underPlane([t,e],n){let[s,r]=this.size,o=new I(...n).applyMatrix4(this.root.matrixWorld).project(this.camera).z,a=new I(2*t/s-1,1-2*e/r,o).unproject(this.camera);return this.root.worldToLocal(a).toArray()}draw(){this.waiting||(this.waiting=requestAnimationFrame(()=>{this.waiting=0,this.keepPace(),this.isFlushed()?this.render():this.draw()}))}keepPace(){let t=performance.now(),e=t-this.last;this.last=t,e<400&&(this.pace=.6*this.pace+.4*e),e<400&&this.pace>sS&&!this.isPlain&&this.flush(),clearTimeout(this.rest),this.isPlain&&(this.rest=setTimeout(()=>{this.plain(!1),this.last=-1e9,this.draw()},250))}flush(){let t=this.renderer.getContext();this.fence??=t.fenceSync(t.SYNC_GPU_COMMANDS_COMPLETE,0),t.flush()}isFlushed(){if(!this.fence)return!0;let t=this.renderer.getContext();return t.getSyncParameter(this.fence,t.SYNC_STATUS)!==t.SIGNALED?!1:(t.deleteSync(this.fence),this.fence=null,this.plain(!0),!0)}plain(t){this.isPlain!==t&&(this.isPlain=t,this.parts.edges.visible=!t,this.sharpen())}sharpen(){let t=Math.min(window.devicePixelRatio||1,2)*(this.isPlain?.5:1);this.renderer.setPixelRatio(t),this.renderer.setSize(...this.size,!1),this.parts.shared.dense.value=t}render(){cancelAnimationFrame(this.waiting),this.waiting=0,this.size&&(this.shoot(this.camera),this.drawn())}shoot(t){this.clip(t),this.scene.updateMatrixWorld(),this.ground.shade(this.renderer,this.isPlain),this.overRoot.quaternion.copy(this.root.quaternion);let{material:e}=this.parts;for(let n of["cap","back","front"])this.root.worldToLocal(e[n].uniforms.eye.value.copy(t.position));this.renderer.clear(),this.renderer.render(this.scene,t),this.renderer.clearDepth(),this.renderer.render(this.over,t)}snap(t){let{width:e,height:n}=t,s=new sn(this.camera.fov,e/n,1,2);this.frame(s,0),this.shootInto(t,s)}shootInto(t,e,n=1){let{width:s,height:r}=t;e.updateMatrixWorld();let o=new Ze(s,r,{samples:4,stencilBuffer:!0}),{dense:a}=this.parts.shared,l=a.value;a.value=n,this.renderer.setRenderTarget(o),this.shoot(e);let c=new Uint8Array(4*s*r);this.renderer.readRenderTargetPixels(o,0,0,s,r,c),this.renderer.setRenderTarget(null),o.dispose(),a.value=l;let h=new ImageData(s,r);for(let u=0;u<r;u+=1){let d=4*s*(r-1-u);h.data.set(c.subarray(d,d+4*s),4*s*u)}t.getContext("2d").putImageData(h,0,0)}drawLines(t){this.lines.geometry.dispose(),this.lines.geometry=new Se,this.lines.geometry.setAttribute("position",new Ce(new Float32Array(t),3)),this.lines.visible=t.length>0}theme(t){this.parts.theme(t),this.motion.theme(t("unstable"),t("surface")),this.forces.theme(t("force"),t("surface"),t("limit")),this.hands.theme(t("grip"),t("surface")),this.loads.theme(t("ink"),t("surface")),this.straps.theme(t("ink"),t("surface")),this.hinges.theme(t("ink"),t("surface")),this.gauge.theme(t("link"),t("surface")),this.open.theme(t("open"),t("ink")),this.lines.material.color.set(t("soft")),this.ghost.theme(t),this.ground.theme(t),this.places.theme(t),this.draw()}};function Mm(i){let t=Ct(me(i),-1),{right:e,front:n}=go(t,0,0),s=[e,t,n].map(r=>new I(...r));return new Ue().setFromRotationMatrix(new ue().makeBasis(...s)).invert()}function Sm(i){let t={label:"",path:"",part:null,children:[],parts:[],groups:new Map};return i.forEach((e,n)=>{let s=e.split("/").filter(Boolean),r=t;t.parts.push(n);for(let a of s.slice(0,-1)){if(!r.groups.has(a)){let l=r.path?`${r.path}/${a}`:a,c={label:a,path:l,part:null,children:[],parts:[],groups:new Map};r.groups.set(a,c),r.children.push(c)}r=r.groups.get(a),r.parts.push(n)}let o=s.length?s[s.length-1]:e;r.children.push({label:o,path:e,part:n,children:[],parts:[n]})}),wm(t).children}function wm(i){let t=i.children.map(n=>n.part===null?wm(n):n);return t.length===1&&i.label?{...t[0],label:`${i.label}/${t[0].label}`}:{...i,children:t}}function Em(i){let t=i.trim().toLowerCase();if(!/[*?]/.test(t))return s=>s.toLowerCase().includes(t);let e=t.replace(/[.+^${}()|[\]\\]/g,"\\$&").replaceAll("*",".*").replaceAll("?","."),n=new RegExp(`^(.*/)?${e}$`,"s");return s=>n.test(s.toLowerCase())}function Lu(i,t,e,n=1){let s=i.slice(0,e),r=s.flatMap(a=>{let l=a.part===null&&t.has(a.path)?Lu(a.children,t,e,n+1):[];return[[a,n],...l]}),o=i.length-s.length;return o>0?[...r,[{more:o,parts:[]},n]]:r}var oS=60,Du=200,ac=class{constructor(t){Object.assign(this,{look:t,box:b("tree"),open:new Set,most:Du,at:0}),this.box.addEventListener("click",e=>this.click(e)),this.box.addEventListener("keydown",e=>this.key(e)),mt("find","input",()=>this.search()),mt("find","keydown",e=>{e.key==="Enter"&&this.selectFound(),e.key==="ArrowDown"&&this.focus(0)}),mt("select-found","click",()=>this.selectFound())}set(t){let e=!this.nodes;this.page=t,this.nodes=Sm(t.parts.names),e&&t.parts.names.length<=oS&&this.openAll(this.nodes),this.search()}openAll(t){for(let e of t.filter(({part:n})=>n===null))this.open.add(e.path),this.openAll(e.children)}search(){let t=b("find").value,{names:e,tails:n}=this.page.parts;if(this.found=null,t.trim()){let r=Em(t),o=e.map((l,c)=>c).filter(l=>r(e[l])),a=l=>r(e[l].slice(e[l].lastIndexOf("/")+1));this.found=[...o.filter(a),...o.filter(l=>!a(l))]}this.most=Du;let s=!!(this.found&&this.found.length);b("select-found").hidden=!s,b("found").textContent=this.found?`${this.found.length} of ${e.length}`:"",this.list=this.found&&this.found.map(r=>({label:n[r],path:e[r],part:r,children:[],parts:[r]})),this.draw()}selectFound(){this.found&&this.found.length&&this.look.choose(this.found)}draw(){this.rows=Lu(this.list||this.nodes,this.open,this.most),this.at=Math.min(this.at,this.rows.length-1),this.box.replaceChildren(...this.rows.map(([t,e],n)=>this.row(t,e,n))),this.mark()}row(t,e,n){let s=document.createElement("div"),r=(p,g,y)=>{let w=document.createElement(p);return w.className=g,w.textContent=y,s.append(w),w};if(s.setAttribute("role","treeitem"),s.setAttribute("aria-level",String(Math.min(e,5))),s.dataset.row=String(n),t.more)return r("bdi","label",`${t.more} more`),s;let o=t.part===null;o&&s.setAttribute("aria-expanded",String(this.open.has(t.path))),r("span","caret",o?this.open.has(t.path)?"\u25BE":"\u25B8":"").setAttribute("aria-hidden","true");let{mass:a,grounded:l,tails:c}=this.page.parts,h=this.list||t.label.includes("/")&&!o?c[t.part]:t.label,u=o?[]:qc(this.page.parts,t.part).map(([p,g])=>`${p} ${g}`);r("bdi","label",h).title=[t.path,...u].join(`
`),this.list&&t.path.includes("/")&&r("bdi","path soft",t.path.slice(0,t.path.lastIndexOf("/")));let d=t.parts.filter(p=>l[p]).length,f=d?o&&d<t.parts.length?`${d} held`:"held":"";r("span","soft",f);let m=t.parts.reduce((p,g)=>p+a[g],0);r("span","soft",`${ve(m,3)} kg`);let x=r("button","eye","");return x.type="button",x.tabIndex=-1,s}mark(){let{selection:t,stage:e}=this.look;[...this.box.children].forEach((n,s)=>{let[r]=this.rows[s];if(n.tabIndex=s===this.at?0:-1,r.more)return;n.setAttribute("aria-selected",String(r.parts.every(l=>t.has(l))));let o=!e||r.parts.some(l=>e.parts.visible[l]);n.classList.toggle("gone",!o);let a=n.lastChild;a.replaceChildren(cS(o)),a.title=o?"hide (v)":"show (v)",a.hidden=!e,a.setAttribute("aria-label",`${o?"hide":"show"} ${r.path}`)})}click(t){let e=t.target.closest("[data-row]");if(!e)return;let n=Number(e.dataset.row),[s]=this.rows[n];this.at=n,s.more?this.more():t.target.closest(".eye")?this.eye(s):t.target.closest(".caret")&&s.part===null?this.toggle(s):this.pick(n,t),this.focus(this.at)}more(){this.most+=Du,this.draw()}toggle(t){this.open.delete(t.path)||this.open.add(t.path),this.draw()}eye(t){let{look:e}=this,n=t.parts.some(s=>e.stage.parts.visible[s]);e.setVisible(t.parts,!n)}pick(t,{shiftKey:e,ctrlKey:n,metaKey:s}){let r=this.rows[t][0].parts;if(e&&this.anchor!==void 0){let[o,a]=[Math.min(t,this.anchor),Math.max(t,this.anchor)];this.look.choose(this.rows.slice(o,a+1).flatMap(([l])=>l.parts));return}this.anchor=t,this.look.choose(r,n||s?"toggle":"only")}key(t){let e=t.target.closest("[data-row]");if(!e||t.altKey)return;let n=Number(e.dataset.row),[s,r]=this.rows[n],o=this.rows.length-1,a={ArrowDown:n+1,ArrowUp:n-1,Home:0,End:o},l=s.part===null&&this.open.has(s.path);if(t.key in a){let c=Math.max(0,Math.min(o,a[t.key]));t.shiftKey&&!this.rows[c][0].more&&(this.anchor??=n,this.pick(c,t)),this.focus(c)}else if(t.key==="ArrowRight"&&s.part===null&&!l)this.toggle(s);else if(t.key==="ArrowLeft"&&l)this.toggle(s);else if(t.key==="ArrowLeft"){let c=n;for(;c>0&&this.rows[c][1]>=r;)c-=1;this.focus(c)}else if(t.key==="Enter"||t.key===" ")s.more?this.more():this.pick(n,t.key===" "?{ctrlKey:!0}:t);else if(t.key==="v"&&!s.more)this.eye(s);else return;t.preventDefault(),t.key in a||this.focus(Math.min(this.at,this.rows.length-1))}focus(t){let e=this.box.children[t];e&&(this.box.children[this.at]?.setAttribute("tabindex","-1"),this.at=t,e.tabIndex=0,e.focus({preventScroll:!0}),e.scrollIntoView({block:"nearest"}))}},aS=["M1 8 C4 3 12 3 15 8 C12 13 4 13 1 8 Z","M8 6 A2 2 0 1 0 8 10 A2 2 0 1 0 8 6 Z"],lS=["M1 8 C4 3 12 3 15 8 C12 13 4 13 1 8 Z","M3 14 L13 2"];function cS(i){let t=(n,s)=>{let r=document.createElementNS("http://www.w3.org/2000/svg",n);for(let[o,a]of Object.entries(s))r.setAttribute(o,a);return r},e=t("svg",{viewBox:"0 0 16 16",width:"15",height:"15","aria-hidden":"true"});return e.append(...(i?aS:lS).map(n=>t("path",{d:n}))),e}var hS=14,uS=40,dS=.1,Am=40,Tm={ArrowLeft:[-.1,0],ArrowRight:[.1,0],ArrowUp:[0,-.1],ArrowDown:[0,.1],"+":[0,0,.9],"-":[0,0,1.1]},fS=4,er=class{constructor(t){this.page=t,this.apart=0,this.long=.42*t.radius;try{this.stage=new oc(b("picture"),t)}catch(e){b("no-picture").hidden=!1,b("no-picture").textContent=`No picture can be drawn: ${e.message}`}this.names=this.stage&&new Go(b("names"),this.stage),this.tree=new ac(this)}tool=null;begin(){this.theme(),this.stage&&(this.compass=new Bo(b("cube"),b("triad"),t=>this.stage.view(t)),this.stage.drawn=()=>{this.names.place(),this.compass.paint(this.stage.axes())},this.stage.render()),this.firstPicture=performance.now()}replace(t){let{names:e}=this.page.parts,n=o=>new Set([...o].map(a=>e[a])),s=n(this.selection),r=this.stage?n([...e.keys()].filter(o=>!this.stage.parts.visible[o])):new Set;if(this.page=t,this.long=.42*t.radius,this.selection=new Set([...t.parts.names.keys()].filter(o=>s.has(t.parts.names[o]))),this.stage){this.stage.replace(t);let{parts:o}=this.stage;t.parts.names.forEach((a,l)=>o.visible[l]=r.has(a)?0:1),o.selected=this.selection,o.patches.visible=b("show-contacts").checked,this.cut(),this.measure.clear(),this.stage.spread(this.spreading()),this.theme()}this.offer(),this.label(),this.tree.set(t),this.renewed(),this.showSelection()}renewed(){}look(){mt("explode","input",()=>this.slide("apart","explode",1.6));for(let s of"xyz")mt(`section-${s}-side`,"change",()=>this.section()),mt(`section-${s}`,"input",()=>this.section());mt("flat","click",()=>this.flatten());for(let[s,r]of[["see-through","input"],["see-through-of","change"]])mt(s,r,()=>{this.seeThrough(),this.legend(),this.stage.draw()});mt("force-size","input",()=>this.repose());for(let s of["show-forces","force-mode","show-thrust"])mt(s,"change",()=>this.repose());if(mt("show-motion","change",()=>this.repose()),mt("show-contacts","change",()=>{this.stage.parts.patches.visible=b("show-contacts").checked,this.repose()}),mt("show-open","change",()=>this.repose()),mt("show-names","change",()=>this.label()),mt("home","click",()=>this.stage.home()),mt("view","change",()=>{let s=pr[b("view").value];b("view").value="",s&&this.stage.view(s)}),mt("theme","click",()=>this.nextTheme()),mt("hide","click",()=>this.hide()),mt("isolate","click",()=>this.isolate()),mt("zoom","click",()=>this.stage.zoomTo([...this.selection])),mt("show-all","click",()=>this.showAll()),mt("copy-name","click",()=>{Pi([...this.selection].map(s=>this.page.parts.names[s]).join(`
`),b("copy-name"))}),matchMedia("(prefers-color-scheme: dark)").addEventListener("change",()=>this.theme()),document.body.addEventListener("click",s=>{let r=s.target.closest&&s.target.closest("button[data-part]");r&&(this.select(Number(r.dataset.part)),b("picture").scrollIntoView({block:"nearest"}))}),this.offer(),this.tree.set(this.page),!this.stage){let s=".tools, .views, #cube, #triad, #legend, .gravity, #part .buttons";for(let r of document.querySelectorAll(s))r.hidden=!0;return}this.measure=new zo(this);let{page:t}=this;b("show-names").checked=t.parts.names.length<=hS;let{start:e,kinds:n}=t.patches;b("show-contacts").checked=e.length-1<=uS&&n.join()!=="bond",this.stage.parts.patches.visible=b("show-contacts").checked,this.label(),this.picking()}offer(){if(!this.stage)return;let{page:t}=this,e=t.open.decides?t.open.decides.filter(Boolean).length:t.open.parts.length/2;b("open-row").hidden=!e,b("open-label").textContent=`${e} open pair${e>1?"s":""}`,b("contacts-row").hidden=t.patches.start.length<2,b("explode-row").hidden=t.parts.names.length<2}slide(t,e,n=1){this[t]=n*Number(b(e).value),t==="apart"&&this.stage&&this.stage.spread(this.spreading()),this.repose()}flatten(){let t=b("flat").getAttribute("aria-pressed")!=="true";b("flat").setAttribute("aria-pressed",String(t)),this.stage.flatten(t)}seeThrough(){let t=Number(b("see-through").value),e=b("see-through-of").value==="rest";b("see-through-row").hidden=!t||!this.movers().length,this.stage.parts.seeThrough(t,e)}movers(){return[]}spreading(){return this.page.extent.map(t=>(1+this.apart)*t)}label(){if(!this.names)return;let t=this.page.parts.names.map((e,n)=>n);this.names.show(b("show-names").checked?t.slice(0,400):[])}loadScale(){if(this.fixedScale)return this.fixedScale;let t=this.page.loads.reduce((e,n)=>Math.max(e,Math.hypot(...n.force)),0);return t?this.long/t:0}marks(){let{stage:t}=this,{loads:e}=this.page,n=this.loadScale(),s=e.filter(r=>Math.hypot(...r.force)>0).map(r=>({...r,at:t.parts.placeOf(r.part,r.point)})).filter(r=>t.parts.seen(r.part,r.at)).map(r=>({at:r.at,along:r.force,size:n*Math.hypot(...r.force),wide:this.long}));t.loads.set({straight:s}),t.straps.set(this.apart||this.amount||this.fell||this.shifted?{}:Dd(this.page)),t.open.set(b("show-open").checked?Ld(t):{}),this.measure.follow(),this.legend()}legend(){let{stage:t,page:e}=this;if(!t)return;let{parts:n}=t,s=a=>a.group.children.length>0,r=e.parts.names.map((a,l)=>l).filter(a=>n.shown(a)),o={base:r.some(a=>e.parts.grounded[a]&&!e.parts.table?.[a]),moving:r.some(a=>n.moving[a]&&!n.gripped[a]),picked:r.some(a=>this.selection.has(a)),grip:r.some(a=>n.gripped[a]),faint:n.anyFaint&&n.sparing,motion:s(t.motion),force:s(t.forces),hand:s(t.hands),patch:n.patches.visible&&e.patches.start.length>1,open:s(t.open),load:s(t.loads),strap:s(t.straps),hinge:s(t.hinges),added:t.ghost.group.visible,seat:t.lines.visible,gauge:s(t.gauge),grid:!e.planar};b("grid-step").textContent=`${Number(t.ground.step.toPrecision(3))} ${e.units}`;for(let[a,l]of Object.entries(o))b(`${a}-key`).hidden=!l}section(){this.cut(),this.repose()}cut(){let t=[];"xyz".split("").forEach((e,n)=>{let s=b(`section-${e}-side`).value;if(b(`section-${e}`).hidden=!s,!s)return;let r=s==="-"?-1:1;t.push([[0,1,2].map(o=>o===n?r:0),r*this.page.radius*Number(b(`section-${e}`).value)])}),this.stage.parts.section(t)}picking(){let t=b("picture"),e=null,n=s=>{let r=t.getBoundingClientRect();return[s.clientX-r.left,s.clientY-r.top]};t.addEventListener("pointerdown",s=>{e=n(s),this.framing=s.shiftKey&&!s.button,this.framing&&(s.stopImmediatePropagation(),t.setPointerCapture(s.pointerId),t.focus({preventScroll:!0}))},{capture:!0}),t.addEventListener("pointermove",s=>this.framing&&e&&this.frame(e,n(s))),t.addEventListener("pointerup",s=>{if(!e||s.button)return;let r=n(s),o=Math.hypot(r[0]-e[0],r[1]-e[1])<fS,a=this.framing&&!o&&this.frame(e,r);if(e=null,this.framing=!1,b("frame").hidden=!0,a)this.choose(this.stage.within(a),"add");else if(o&&this.tool)this.tool.click(...r);else if(o&&this.measure.on)this.measure.click(...r);else if(o){let l=this.stage.pick(...r),c=s.shiftKey||s.ctrlKey||s.metaKey;l>=0&&c?this.choose([l],"toggle"):c||this.select(l)}}),t.addEventListener("pointercancel",()=>{[e,this.framing]=[null,!1],b("frame").hidden=!0}),t.addEventListener("pointermove",s=>s.buttons||this.hover(n(s))),t.addEventListener("pointerleave",()=>this.hovered(-1)),document.addEventListener("keydown",s=>this.hotkey(s))}hover(t){this.pointer=t,!this.hovering&&(this.hovering=setTimeout(()=>{let e=performance.now();this.hovered(this.stage.pick(...this.pointer)),this.pause=Math.max(Am,8*(performance.now()-e)),this.hovering=0},this.pause??Am))}hovered(t){let{parts:e}=this.stage;e.hovered!==t&&(e.hovered=t,b("picture").title=t<0?"":this.page.parts.tails[t],e.states(),this.stage.draw())}hotkey(t){let{target:e,key:n}=t;if(t.ctrlKey||t.metaKey||t.altKey||t.defaultPrevented||e.matches?.("input:not([type=range], [type=checkbox], [type=file]), textarea, select")||document.querySelector("dialog[open]"))return;let s=e===b("picture"),r=/^[a-z?]$/i.test(n)||n==="Escape"||e===document.body&&/^[-+0-9]$/.test(n);(s||r)&&this.press(n,t.shiftKey)&&t.preventDefault()}press(t,e){let{stage:n}=this,{count:s}=n.parts,r=t.toLowerCase();if(this.key(t))return!0;if(Tm[t])n.orbit(...Tm[t]);else if($c[t])n.view(pr[$c[t]]);else if(t==="0")n.home();else if(r==="n"||r==="p"){let o=this.selected<0?0:(this.selected+(r==="n"?1:s-1))%s;this.choose([o],e?"add":"only")}else if(t==="f")this.fit();else if(t==="v")this.hide();else if(t==="i")this.isolate();else if(t==="a")this.showAll();else if(t==="m")this.measure.toggle();else if(t==="Escape"&&this.measure.on)this.measure.toggle(!1);else if(t==="Escape")this.select(-1);else return!1;return!0}fit(){this.selection.size?this.stage.zoomTo([...this.selection]):this.stage.home()}frame(t,e){let[n,s]=[Math.min(t[0],e[0]),Math.max(t[0],e[0])],[r,o]=[Math.min(t[1],e[1]),Math.max(t[1],e[1])],a=b("frame");a.hidden=!1;let l={left:n,top:r,width:s-n,height:o-r};for(let[c,h]of Object.entries(l))a.style[c]=`${h}px`;return[n,r,s,o]}key(){return!1}selection=new Set;get selected(){return[...this.selection].at(-1)??-1}select(t){this.choose(t<0?[]:[t])}choose(t,e="only"){if(e==="only")this.selection=new Set(t);else{let n=e==="toggle"&&t.every(s=>this.selection.has(s));for(let s of t)this.selection.delete(s);if(!n)for(let s of t)this.selection.add(s)}this.showSelection()}bring(t){this.choose(t),this.stage&&this.stage.zoomTo(t,dS*this.page.radius)}showSelection(){this.stage&&(this.stage.parts.selected=this.selection,this.stage.parts.states(),this.stage.draw(),this.legend());let t=this.selection.size>0;b("part").hidden=!t,b("no-part").hidden=t,this.tree.mark(),t&&this.showPart(this.selected)}showPart(t){let{names:e,tails:n}=this.page.parts,s=this.selection.size>1;b("part-name").textContent=s?`${this.selection.size} parts`:n[t],b("part-name").title=s?"":e[t],b("copy-name").dataset.label=s?"Copy full names":"Copy full name",b("copy-name").textContent=b("copy-name").dataset.label;let r=s?zd(this.page,[...this.selection]):kd(this.page,this.found,t);Mo(b("part-facts"),r)}setVisible(t,e){for(let n of t)this.stage.parts.visible[n]=e?1:0;this.seen()}seen(){let{parts:t}=this.stage;t.states(),b("show-all").hidden=t.visible.every(Boolean),this.tree.mark(),this.repose()}hide(){if(!this.selection.size)return;let t=[...this.selection];this.select(-1),this.setVisible(t,!1)}isolate(){this.selection.size&&(this.stage.parts.visible.fill(0),this.setVisible(this.selection,!0))}showAll(){this.stage.parts.visible.fill(1),this.seen()}nextTheme(){let t=document.documentElement,e=matchMedia("(prefers-color-scheme: dark)").matches,n=t.dataset.theme||(e?"dark":"light");t.dataset.theme=n==="dark"?"light":"dark",this.theme()}theme(){this.stage&&this.stage.theme(qn(document.documentElement))}speed(t=20){let{renderer:e}=this.stage,n=new Uint8Array(4),s=e.getContext(),r=()=>s.readPixels(0,0,1,1,s.RGBA,s.UNSIGNED_BYTE,n);r();let o=performance.now();for(let a=0;a<t;a+=1)this.stage.orbit(.05,0),this.stage.render(),r();return 1e3*t/(performance.now()-o)}};var nr=class{constructor(t,e,n,s){Object.assign(this,{list:t,page:e,go:n,paint:s,now:-1,stale:new Set}),this.buttons=e.plan.steps.map((r,o)=>this.button(r,o)),t.replaceChildren(...this.buttons.map(r=>{let o=document.createElement("li");return o.append(r),o})),t.addEventListener("keydown",r=>this.key(r)),addEventListener("beforeprint",()=>this.finish()),this.seen=new IntersectionObserver(r=>{r.forEach(o=>o.isIntersecting&&this.want(this.buttons.indexOf(o.target)))},{rootMargin:"300px"}),this.renew()}button(t,e){let n=(h,u,d)=>{let f=document.createElement(h);return f.className=u,f.textContent=d,f},s=n("button","step","");s.type="button",s.tabIndex=e?-1:0;let r=document.createElement("canvas");r.width=336,r.height=252;let{tails:o}=this.page.parts,a=t.parts.map(h=>o[h]).join(", "),l=t.held.map(h=>o[h]).join(", "),c=n("bdi","step-name",a);return s.append(r,n("span","step-number",String(e+1)),c),l&&s.append(n("span","step-held",`hold ${l}`)),s.addEventListener("click",()=>this.go(e)),s}key(t){let e=this.buttons.length-1,n={ArrowLeft:this.now-1,ArrowRight:this.now+1,Home:0,End:e};if(!(t.key in n))return;t.preventDefault();let s=Math.max(0,Math.min(e,n[t.key]));this.go(s),this.buttons[s].focus()}mark(t){if(this.now===t)return;this.now=t,this.buttons.forEach((r,o)=>{r.tabIndex=o===t?0:-1,o===t?r.setAttribute("aria-current","step"):r.removeAttribute("aria-current")});let[e,n]=[this.buttons[t].parentElement,this.list],s=e.offsetLeft-n.offsetLeft;(s<n.scrollLeft||s+e.offsetWidth>n.scrollLeft+n.clientWidth)&&(n.scrollLeft=s-(n.clientWidth-e.offsetWidth)/2)}renew(){this.stale=new Set(this.buttons.keys()),this.queue=[],this.seen.disconnect(),this.buttons.forEach(t=>this.seen.observe(t))}want(t){!this.stale.has(t)||this.queue.includes(t)||(this.queue.push(t),this.busy||this.next())}next(){let t=this.queue.shift();this.busy=t!==void 0,this.busy&&(this.draw(t),setTimeout(()=>this.next(),0))}draw(t){this.stale.delete(t),this.paint(t,this.buttons[t].firstChild)}finish(){for(let t of[...this.stale])this.draw(t)}};var pS=1250,mS={found:"\u2713",impossible:"\u2715",fails:"\u2715","none-found":"?"},gS={found:"stable",impossible:"unstable",fails:"unstable"},lc=class extends er{constructor(t){super(t);let{plan:e}=t;this.film=new ms(this,e),this.count=this.film.count,this.time=0,this.atFirst=!0,this.outside=this.film.overhang(),this.stage&&this.stage.spread(this.spreading()),this.found={moving:[],motion:null,forces:null},this.look(),this.tell(),this.controls(),this.theme(),this.count?this.go(this.film.pictureAt(0)):this.go(0),this.begin(),this.stage&&this.count&&this.strip.renew()}tell(){let{plan:t}=this.page;b("banner").dataset.verdict=gS[t.verdict]||"undecided",b("sign").textContent=mS[t.verdict]||"?",b("verdict").textContent=t.word,b("sentence").textContent=t.sentence,b("moving").textContent=t.more}controls(){let{plan:t}=this.page;for(let s of["force-mode","thrust"])b(`${s}-row`).hidden=!0;let e=t.falls.length||t.steps.some(s=>s.hands.some(r=>r.motion));b("motion-check").hidden=!e,b("motion-key-words").textContent=this.count?"insertion, or motion without the hand":"motion of the falling parts",b("force-key-words").textContent="support force",b("show-forces").parentElement.hidden=!this.count;for(let s of["player","step-card"])b(s).hidden=!this.count;if(!this.count){b("motion-word").textContent="motion of the falling parts";return}b("motion-word").textContent="motion without the hand",b("show-motion").checked=!1,b("scrub").max=String(this.count),mt("scrub","input",()=>this.go(Number(b("scrub").value),!0)),mt("play","click",()=>this.play()),mt("back","click",()=>this.jump(-1)),mt("forward","click",()=>this.jump(1)),mt("pace","change",()=>this.playing&&this.start());let n=(s,r)=>this.paint(s,r);this.strip=new nr(b("strip"),this.page,s=>this.show(s),n),document.body.addEventListener("click",s=>{let r=s.target.closest&&s.target.closest("[data-step]");r&&this.show(Number(r.dataset.step))}),this.nodes=[...document.querySelectorAll("#graph [data-step]")],t.steps.length>60&&(b("pace").value="2")}spreading(){let{explode:t}=this.page.plan,e=[0,1,2].map(n=>t.reduce((s,r,o)=>o%3===n?Math.max(s,Math.abs(r)):s,0));return this.page.extent.map((n,s)=>n+Math.max(this.apart*e[s],this.outside[s]))}key(t){if(!this.count)return!1;if(t===" ")this.play();else if(t===",")this.jump(-1);else if(t===".")this.jump(1);else if(t==="Home")this.go(0,!0);else if(t==="End")this.go(this.count,!0);else return!1;return!0}show(t){this.go(this.film.pictureAt(t),!0)}jump(t){this.go(this.film.jumped(this.time,t),!0)}go(t,e=!1){if(e&&this.playing&&this.pause(),e&&(this.atFirst=!1),this.time=Math.max(0,Math.min(this.count,t)),this.count){b("scrub").value=String(this.time);let[n]=this.film.stepAt(this.time);n!==this.told&&this.tellStep(n);let s=this.time>=this.count?"assembled":`step ${n+1} of ${this.count}`;b("when").textContent=s,b("scrub").setAttribute("aria-valuetext",s)}this.repose()}play(){this.playing?this.pause():this.start()}start(){(this.time>=this.count||this.atFirst)&&(this.time=0),this.atFirst=!1;let t=pS/Number(b("pace").value),[e,n]=[performance.now(),this.time],s=matchMedia("(prefers-reduced-motion: reduce)").matches;this.playing=e,b("play").textContent="Pause";let r=o=>{if(this.playing!==e)return;let a=Math.min(this.count,n+Math.max(0,o-e)/t),l=a>=this.count;s&&!l&&(a=this.film.pictureAt(Math.floor(a))),this.go(a),l?this.pause():requestAnimationFrame(r)};requestAnimationFrame(r)}pause(){this.playing=null,b("play").textContent="Play"}tellStep(t){let e=this.page.plan.steps[t];this.told=t,b("step-title").textContent=`Step ${t+1} of ${this.count}`,b("step-name").textContent=e.parts.map(n=>this.page.parts.names[n]).join(", "),Mo(b("step-facts"),e.facts),this.strip.mark(t),this.nodes.forEach(n=>n.classList.toggle("now",Number(n.dataset.step)===t)),this.stage&&this.stage.turnTo(e.down)}repose(){if(!this.stage)return;this.film.place(this.time,this.apart);let t=this.film.arrows(this.time);b("force-label").textContent=t?`support forces, up to ${ln(t)}`:"support forces",this.drawLines(),this.marks(),this.names.place(),this.stage.draw()}drawLines(){let{stage:t,page:e}=this,n=[];if(this.apart>0){let s=this.film.spread(this.apart);for(let r=0;r<t.parts.count;r+=1){let o=e.parts.center.subarray(3*r,3*r+3);!t.parts.shown(r)||!Math.hypot(...s[r])||n.push(...o,...s[r].map((a,l)=>a+o[l]))}}t.drawLines(n)}paint(t,e){this.stage&&(this.film.paint(t,e),this.repose())}showPart(t){super.showPart(t);let{steps:e,base:n}=this.page.plan,s=e.findIndex(o=>o.parts.includes(t)),r=n.includes(t)?"in place from the start":s<0?"not in the plan":`step ${s+1}`;[...b("part-facts").querySelectorAll("dt")].filter(o=>o.textContent==="state").forEach(o=>{o.textContent="inserted",o.nextSibling.textContent=r})}theme(){super.theme(),this.stage&&this.strip&&this.strip.renew()}};var cc=["stable","settles","potentially-stable","balanced"],_S=20,xS=1e-9;function Cm(i,t){for(let o of["given","recommended","probed"]){let a=i[o];if(a&&Be(a.down,t)<xS)return yS(i,o,a,t)}let{region:e}=i;if(!e)return{verdict:"unknown",from:"none",margin:null,moving:null};let n=vS(e,t),s=n===e.inside,r={verdict:n,from:"cone",...Rm(i,t,s),moving:null};if(s)r.moving=[],r.forces=bS(i.rays,t);else if(i.map){let[o,a]=To(i.map.vertices,t),l=i.parts.radius.length;r.motion=i.map.motions.subarray(6*l*o,6*l*(o+1)),r.moving=Ro(r.motion,i.parts.radius),r.z=Math.min(0,-a),r.moving.length||(r.motion=null)}return r}var fs=i=>({...i,...i.inner}),Nu=i=>i.inner?{...i,equations:[],dimension:3}:i;function vS(i,t){return Ti(fs(i),t)?i.inside:i.inner&&Ti(Nu(i),t)?"undecided":i.outside}function Uu(i,t){let e=fs(i),n=Math.max(0,-e.blur),s=Fc({...e,blur:Math.abs(e.blur)},t);return s&&n&&i.center?me(Xt(s,Ct(i.center,_S*n))):s}function yS(i,t,e,n){let s=cc.includes(e.verdict),r=[];return e.moves.forEach((a,l)=>a&&r.push(l)),{...i.region?Rm(i,n,Ti(fs(i.region),n)):{margin:null},verdict:e.verdict,from:t,moving:r,motion:e.motion||(e.fall&&!e.fall.places?e.fall.begins:null),z:e.z,instability:e.instability,sentence:e.sentence,level:e.level,words:e.words,forceWords:e.force_words,forces:s?e.forces:null,fall:e.fall||null}}function Rm(i,t,e){let{region:n}=i,s=fs(n);if(!e)return{margin:null,away:No({...s,blur:Math.abs(s.blur)},t)};let r=_d(s,t);return{margin:Ci(n,i.planar)?0:r,within:r,away:0}}function bS(i,t){let e=i&&bd(i.downs,t);if(!e)return null;let n=i.points.length,s=new Float32Array(n);for(let[r,o]of e)for(let a=0;a<n;a+=1)s[a]+=o*i.forces[r*n+a];return{points:i.points,parts:i.parts,patch:i.patch,forces:s}}var En=5,MS=.08;function SS(i){let t=[[0,-En],[En,0],[0,En],[-En,0]],e=[[-En,-En],[En,En],[0,0],[En,-En],[-En,En],[0,0]];return{corners:{minimum:t,balanced:e,open:t}[i]??null,filled:i==="minimum",dashed:i==="open"}}function Pm(i,t){let e=null,n=MS;for(let s of i){let r=Be(s.down,t);r<=n&&([e,n]=[s,r])}return e}function Im(i,t,e,n){for(let s of t){let[r,o,a]=e(s.down);if(a<0)continue;let{corners:l,filled:c,dashed:h}=SS(s.state);i.beginPath(),l?l.forEach(([u,d],f)=>f?i.lineTo(r+u,o+d):i.moveTo(r+u,o+d)):i.arc(r,o,En,0,2*Math.PI),i.closePath(),i.setLineDash(h?[2,2]:[]),i.lineWidth=4,i.strokeStyle=n("surface"),i.stroke(),i.lineWidth=1.75,i.strokeStyle=n("ink"),i.fillStyle=c?n("ink"):"transparent",i.fill(),i.stroke()}i.setLineDash([])}var wS=30,Ou=23,ES=24,AS=.5,Lm=Math.PI/90,hc=class{constructor(t,e,n){Object.assign(this,{canvas:t,turned:n}),this.marked=()=>{},this.eye=e.planar?[0,0]:[.55,-.42],this.down=e.given.down,this.replace(e),this.layer=document.createElement("canvas"),t.addEventListener("pointerdown",s=>this.press(s)),t.addEventListener("pointermove",s=>this.move(s)),t.addEventListener("pointerup",s=>this.release(s)),t.addEventListener("pointercancel",()=>this.drag=null),t.addEventListener("keydown",s=>this.key(s))}replace(t){this.page=t,this.above=Ct(me(t.given.down),-1),this.most=t.map&&Co(t.map)||1,this.stale=!0}get view(){return go(this.above,...this.eye)}set(t,e=!1){this.down=t,e&&!this.page.planar&&Lt(t,this.view.front)<.12&&(this.eye=ym(this.above,t),this.stale=!0),this.draw()}place(t){let[e,n,s]=rc(this.view,t),{middle:r,radius:o}=this.frame();return{x:r+o*e,y:r-o*n,front:s>=0}}frame(){let t=this.canvas.clientWidth||260;return{side:t,middle:t/2,radius:t/2-wS}}under(t){let e=this.canvas.getBoundingClientRect(),{middle:n,radius:s}=this.frame(),r=(t.clientX-e.left-n)/s,o=-(t.clientY-e.top-n)/s,a=xm(this.view,r,o);return{x:r,y:o,direction:this.page.planar?vm(a):a}}press(t){if(t.button)return;this.canvas.focus({preventScroll:!0}),this.canvas.setPointerCapture(t.pointerId);let e=this.canvas.getBoundingClientRect(),n=this.place(this.down),r=Math.hypot(t.clientX-e.left-n.x,t.clientY-e.top-n.y)<ES&&n.front;this.drag={holds:r,at:[t.clientX,t.clientY],far:0,eye:[...this.eye]},t.preventDefault()}move(t){if(!this.drag)return this.point(t);let[e,n]=[t.clientX-this.drag.at[0],t.clientY-this.drag.at[1]];if(this.drag.far=Math.max(this.drag.far,Math.hypot(e,n)),this.drag.holds)this.turned(this.under(t).direction,"pointer");else if(!this.page.planar&&this.drag.far>3){let{radius:s}=this.frame(),r=this.drag.eye[1]+n/s;this.eye=[this.drag.eye[0]-e/s,Math.max(-1.5,Math.min(1.5,r))],this.stale=!0,this.draw()}}point(t){let{x:e,y:n,direction:s}=this.under(t),r=Math.hypot(e,n)<=1.05?Pm(this.rests,s):null;this.canvas.title=r?r.words:""}get rests(){return this.page.region?.rests??[]}release(t){if(!this.drag)return;let e=!this.drag.holds&&this.drag.far<=3,n=this.drag.holds;this.drag=null;let{x:s,y:r,direction:o}=this.under(t);e&&Math.hypot(s,r)<=1.05?this.turned(o,"pointer"):n&&this.set(this.down,!0)}key(t){let{up:e,right:n,front:s}=this.view,r=t.shiftKey?Lm/10:Lm,a={ArrowLeft:Ct(n,-1),ArrowRight:n,ArrowUp:e,ArrowDown:Ct(e,-1)}[t.key];if(!a||t.ctrlKey||t.metaKey||t.altKey)return;t.preventDefault();let l=Dn(a,this.down);this.page.planar&&(l=Dn(l,[0,1,0])),Ht(l)<.001&&(l=Dn(Ct(s,-1),this.down)),this.page.planar&&Ht(Dn(l,[0,1,0]))<.001&&(l=ce([0,1,0],this.down)),this.turned(Po(this.down,me(ce(this.down,l)),r),"key",r)}draw(){this.waiting||(this.waiting=requestAnimationFrame(()=>{this.waiting=0,this.paint()}))}paint(){let{side:t}=this.frame(),e=Math.min(window.devicePixelRatio||1,2),n=Math.round(t*e);(this.canvas.width!==n||this.canvas.height!==n)&&(this.canvas.width=n,this.canvas.height=n,this.stale=!0);let s=qn(this.canvas),r=s("surface")+s("stable");this.key_!==r&&(this.key_=r,this.stale=!0),this.stale&&!this.page.planar&&this.paintLayer(e,s),this.stale=!1;let o=this.canvas.getContext("2d");o.setTransform(e,0,0,e,0,0),o.clearRect(0,0,t,t),this.paintArrow(o,s,!1),this.page.planar?this.paintRing(o,s):o.drawImage(this.layer,0,0,t,t),this.paintAxes(o,s),this.paintRegion(o,s),Im(o,this.rests,a=>this.onCanvas(a),s),this.paintMarks(o,s),this.paintArrow(o,s,!0)}paintLayer(t,e){let{side:n,middle:s,radius:r}=this.frame(),o=this.page.map&&this.page.map.vertices.length>180,a=(this.drag&&!this.drag.holds||o?.5:1)*t,l=Math.round(n*a);this.layer.width=l,this.layer.height=l;let c=this.layer.getContext("2d"),h=c.createImageData(l,l),{right:u,up:d,front:f}=this.view,m=this.painter(e,1/(r*a)),x=[0,0,0];for(let p=0;p<l;p+=1){let g=-((p+.5)/a-s)/r;for(let y=0;y<l;y+=1){let w=((y+.5)/a-s)/r,S=w*w+g*g;if(S>1.03)continue;let T=Math.sqrt(Math.max(0,1-S));for(let P=0;P<3;P+=1)x[P]=w*u[P]+g*d[P]+T*f[P];let A=m(x),_=.8+.2*Math.min(1,.55*T+.35*g-.25*w+.45),E=Math.max(0,Math.min(1,(1-Math.sqrt(S))*r*a+.5)),O=4*(p*l+y);for(let P=0;P<3;P+=1)h.data[O+P]=A[P]*_;h.data[O+3]=244*E}}c.putImageData(h,0,0)}painter(t,e){let{region:n,map:s,planar:r}=this.page,[o,a]=[Zi(t("stable-fill")),wo(t)],l=n&&n.outside==="unstable"?"unstable-fill":"blank",c=Zi(t(l)),h=n&&n.dimension===3&&!Ci(n,r),u=h?fs(n).facets:[],d=n&&n.inner?Nu(n).facets:null,f=Zi(t("undecided-fill")),m=[0,0,0],x=(p,g)=>{let y=1/0;for(let w of p)y=Math.min(y,w[0]*g[0]+w[1]*g[1]+w[2]*g[2]);return Math.max(0,Math.min(1,y/e+.5))};return p=>{let g=c;r&&n&&Ti(fs(n),p)?g=o:s&&(g=So(To(s.vertices,p)[1]/s.mass/this.most,a));let y=d?x(d,p):0,w=h?x(u,p):0;for(let S=0;S<3;S+=1){let T=g[S]+y*(f[S]-g[S]);m[S]=T+w*(o[S]-T)}return m}}paintRing(t,e){let{middle:n,radius:s}=this.frame(),r=this.painter(e,1e-6);t.lineWidth=12;for(let o=0;o<180;o+=1){let[a,l]=[o*Math.PI/90,(o+1.1)*Math.PI/90],c=r([Math.cos(a),0,Math.sin(a)]);t.strokeStyle=`rgb(${c.map(Math.round).join()})`,t.beginPath(),t.arc(n,n,s,-a,-l,!0),t.stroke()}}beside(t,e){let{side:n}=this.frame(),[s,r,o]=this.onCanvas(this.down),a=([c,h])=>(o<0||Math.hypot(c-s,h-r)>Ou)&&Math.min(c,h,n-c,n-h)>8,l=Array.from({length:16},(c,h)=>{let u=Math.PI*h/8;return[s+1.05*Ou*Math.cos(u),r+1.05*Ou*Math.sin(u)]});return l.sort((c,h)=>Math.hypot(c[0]-t[0],c[1]-t[1])-Math.hypot(h[0]-t[0],h[1]-t[1])),[t,...l].find(a)||e}paintAxes(t,e){let{middle:n,radius:s}=this.frame();t.font="600 12px system-ui, sans-serif",t.textAlign="center",t.textBaseline="middle","xyz".split("").forEach((r,o)=>{for(let a of[1,-1]){let l=[0,0,0];l[o]=a;let[c,h,u]=rc(this.view,l);if(u<-.02||this.page.planar&&o===1)continue;let[d,f]=[n+s*c,n-s*h];t.fillStyle=e("ink"),t.beginPath(),t.arc(d,f,2,0,2*Math.PI),t.fill();let m=13/Math.max(Math.hypot(c,h),.25),x=`${a>0?"+":"\u2212"}${r}`;Dm(t,x,...this.beside([d+m*c,f-m*h],[d,f]),e)}})}paintRegion(t,e){if(!this.page.region)return;let{region:n}=this.page;n.inner&&n.gap_deg>AS&&this.paintArcs(t,yd(n.facets),[[e("undecided"),1.5,!0]]);let s=xd(n);this.paintArcs(t,s,[[e("stable"),1.5,!1],[e("stable-edge"),5.5,!0],[e("stable"),3,!0]]);for(let r of s)r.angle||this.dot(t,r.u,e)}paintArcs(t,e,n){let s=e.filter(r=>r.angle).map(r=>{let o=Math.max(2,Math.ceil(r.angle/.02));return Array.from({length:o+1},(a,l)=>this.onCanvas(vd(r,l*r.angle/o)))});t.lineCap="round",t.lineJoin="round";for(let[r,o,a]of n){t.strokeStyle=r,t.lineWidth=o,t.setLineDash(a?[]:[3,5]),t.beginPath();for(let l of s){let c=!1;for(let[h,u,d]of l){let f=a?d>=-.01:d<.01;f&&c?t.lineTo(h,u):f&&t.moveTo(h,u),c=f}}t.stroke()}t.setLineDash([])}onCanvas(t){let{middle:e,radius:n}=this.frame(),[s,r,o]=rc(this.view,t);return[e+n*s,e-n*r,o]}dot(t,e,n){let[s,r,o]=this.onCanvas(e);t.fillStyle=o>=0?n("stable"):"transparent",t.strokeStyle=o>=0?n("stable-edge"):n("stable"),t.lineWidth=2,t.setLineDash(o>=0?[]:[2,3]),t.beginPath(),t.arc(s,r,7,0,2*Math.PI),t.fill(),t.stroke(),t.setLineDash([])}paintMarks(t,e){let n=[];for(let[s,r]of[["given","G"],["recommended","R"]]){let o=this.page[s],a=s==="recommended"&&o&&Be(o.down,this.page.given.down);if(!o||s==="recommended"&&a<.12)continue;let[l,c,h]=this.onCanvas(o.down);h<0||Be(o.down,this.down)<.14||(t.font="700 12px system-ui, sans-serif",Dm(t,r,l+13,c-11,e),t.strokeStyle=e("ink"),t.lineWidth=1.5,t.strokeRect(l-4,c-4,8,8),n.push(`${r} ${s}`))}this.marked(n)}paintArrow(t,e,n){let{middle:s}=this.frame(),[r,o,a]=this.onCanvas(this.down);if(a>=-.001!==n){if(!n)return;t.strokeStyle=e("ink"),t.lineWidth=1.5,t.setLineDash([3,3]),t.beginPath(),t.arc(r,o,9,0,2*Math.PI),t.stroke(),t.setLineDash([]);return}t.lineCap="round";for(let[l,c,h]of[[e("surface"),7,12],[e("ink"),3.5,10.5]])t.strokeStyle=l,t.fillStyle=l,t.lineWidth=c,t.beginPath(),t.moveTo(s,s),t.lineTo(r,o),t.stroke(),t.beginPath(),t.arc(r,o,h,0,2*Math.PI),t.fill();t.font="700 12px system-ui, sans-serif",t.textAlign="center",t.textBaseline="middle",t.fillStyle=e(this.tone||"soft"),t.beginPath(),t.arc(r,o,8.5,0,2*Math.PI),t.fill(),t.fillStyle=e("surface"),t.fillText("g",r,o-.5)}};function Dm(i,t,e,n,s){i.textAlign="center",i.textBaseline="middle",i.lineJoin="round",i.lineWidth=3,i.strokeStyle=s("surface"),i.strokeText(t,e,n),i.fillStyle=s("ink"),i.fillText(t,e,n)}var TS=2400,CS=(i,t)=>Math.min(1,Math.max(0,i))**t,_o=class{constructor(t,e,n){Object.assign(this,{power:e,show:n,playing:null}),this.button=b(`${t}-play`),this.slider=b(`${t}-at`),mt(`${t}-play`,"click",()=>this.play()),mt(`${t}-at`,"input",()=>{this.stop(),this.show(Number(this.slider.value))})}play(){if(this.playing){this.stop();return}let t=Number(this.slider.value),e=t<1?t**(1/this.power):0,n=performance.now();this.playing=n,this.button.textContent="Pause";let s=r=>{if(this.playing!==n)return;let o=e+Math.max(0,r-n)/TS;this.show(CS(o,this.power)),o>=1?this.stop():requestAnimationFrame(s)};requestAnimationFrame(s)}stop(){this.playing=null,this.button.textContent="Play"}};function wt(i,t,e=""){let n=document.createElement("button");return n.type="button",n.textContent=i,e&&(n.title=e),n.addEventListener("click",t),n}function Ie(i,...t){let e=document.createElement("li"),n=document.createElement("span");return n.textContent=i,e.append(n,...t),e}function Hn(i,...t){let e=[...i.querySelectorAll("button, select, input")].indexOf(document.activeElement);if(i.replaceChildren(...t),e<0)return;let n=[...i.querySelectorAll("button, select, input")];n.length&&n[Math.min(e,n.length-1)].focus()}function ir(i,t,e,...n){if(!e.length){i.replaceChildren();return}let[s,r]=[document.createElement("h3"),document.createElement("ul")];s.textContent=t,r.className="entries",r.append(...e),Hn(i,s,...n,r)}function cn(i,t,e=null){let n=i.trim().split(/[\s,;]+/).filter(Boolean),s=o=>e!==null&&/g$/i.test(o)?e*Number(o.slice(0,-1)||NaN):Number(o),r=n.map(s);return r.length===t&&r.every(Number.isFinite)?r:null}function Nm(i){let t=i.trim();return t.endsWith("%")?Number(t.slice(0,-1)||NaN)/100:t.endsWith("deg")?Math.tan(Number(t.slice(0,-3)||NaN)*Math.PI/180):Number(t||NaN)}var Wn=i=>i.value.trim()||i.placeholder;var RS=60,PS="joined",IS="\u2713",uc=class{constructor(t){this.report=t,this.choose=null,this.coloured=!1,this.warned="[]"}tell(t){let{assume:e=null,rows:n=[],bodies:s=[]}=t??{};LS(e,n),b("assumptions").hidden=!n.length&&!s.length,Hn(b("ladder"),...n.map(l=>this.row(l,e)));let r=s.filter(l=>l.loose),o=s.filter(l=>!l.loose);this.list("loose-bodies","Loose bodies",r),this.list("bodies","Bodies on the floor, or held",o),this.colour(e===PS&&s.length>0);let a=JSON.stringify(r.map(({parts:l})=>l));this.coloured&&a!==this.warned&&this.report.blink(r.flatMap(({parts:l})=>l)),this.coloured&&(this.warned=a)}colour(t){let e=b("colour-of");t!==this.coloured&&(this.coloured=t,t?e.value="body":e.value==="body"&&(e.value="own"),this.report.repose())}row(t,e){let n=document.createElement("li"),s=[Fu("b",Um(t)),Fu("span",ji(this.report.page,t.words))];if(this.choose){let r=wt("",()=>this.choose(t),t.condition);r.className="rung",r.setAttribute("aria-pressed",String(t.assume===e&&t.friction===null)),r.append(...s),n.append(r)}else n.className="rung",n.title=t.condition,t.assume===e&&t.friction===null&&n.setAttribute("aria-current","true"),n.append(...s);return n}list(t,e,n){let{report:s}=this,r=n.flatMap(({parts:o})=>o);ir(b(t),`${e} (${n.length})`,n.slice(0,RS).map(o=>{let a=Ie(""),l=Fu("i","");l.className="swatch";let c=s.page.given.assumption.bodies.indexOf(o);l.style.background=`rgb(${Eo(qn(document.body),c)})`;let h=wt(ji(s.page,o.words),()=>s.bring(o.parts),"select the parts of this body");return h.className="link",a.firstChild.append(l,h),a}),...n.length>1?[wt("Select all of them",()=>s.choose(r))]:[])}};function dc(i){for(let t of fc())t.setAttribute("aria-pressed",String(t.dataset.rung===i))}var fc=()=>[...document.querySelectorAll("#rungs button")];function LS(i,t){dc(i);for(let e of fc()){let n=t.find(({assume:s,friction:r})=>s===e.dataset.rung&&r===null);e.textContent=n?Um(n):e.dataset.rung,e.setAttribute("aria-label",n?`${e.dataset.rung}: ${n.words}`:e.dataset.rung)}}var Um=i=>`${i.holds?`${IS} `:""}${i.name}`;function Fu(i,t){let e=document.createElement(i);return e.textContent=t,e}var DS=4e-4,Om=24,NS=10,US=3e7,Fm=5,je=(i,t)=>[i[0]-t[0],i[1]-t[1],i[2]-t[2]],Bu=new WeakMap;function OS(i){return Bu.has(i)||Bu.set(i,FS(i)),Bu.get(i)}function FS({positions:i,triangles:t}){let e=[];for(let h=0;h<i.length;h+=3)e.push([...i.subarray(h,h+3)]);let[n,s,r]=[new Map,new Map,Math.max(...e.map(Ht))];for(let h=0;h<t.length;h+=3){let u=[...t.subarray(h,h+3)];for(let y=0;y<3;y+=1){let w=[u[y],u[(y+1)%3]].sort((S,T)=>S-T);n.set(w.join(),w)}let[d,f,m]=u.map(y=>e[y]),x=ce(je(f,d),je(m,d));if(!(Ht(x)>1e-12*r*r))continue;let p=Ct(x,1/Ht(x)),g={n:p,d:Lt(p,d)};s.set([...p,g.d/r].map(y=>Math.round(y*1e4)).join(),g)}let o=[...s.values()],a=o.every(({n:h,d:u})=>e.every(d=>Lt(h,d)<u+1e-5*r)),l=[0,1,2].map(h=>Math.min(...e.map(u=>u[h]))),c=[0,1,2].map(h=>Math.max(...e.map(u=>u[h])));return{corners:e,edges:[...n.values()],triangles:t,planes:a?o:null,low:l,high:c}}function zm(i,t,e){let n={left:US},s=BS(i,t,e).map(([a,l])=>{let c=DS*Math.min(i.parts.radius[a],i.parts.radius[l]);for(let h=0;h<24&&Bm(i,null,0,a,l,c,n);h+=1)c*=2;return[a,l,c]}),r=a=>s.every(([l,c,h])=>!Bm(i,t,a,l,c,h,n))&&n.left>0,o=0;for(let a=1;a<=Om;a+=1){let l=a*e/Om;if(r(l)){o=l;continue}for(let c=0;c<NS;c+=1){let h=(o+l)/2;r(h)?o=h:l=h}return o}return e}function BS(i,t,e){let{center:n,radius:s,position:r}=i.parts,o=Array.from(s,(u,d)=>e*ur(t,d,u)),a=Array.from(s,(u,d)=>u+o[d]),l=[...s.keys()].sort((u,d)=>n[3*u]-a[u]-n[3*d]+a[d]),c=[],h=[];for(let u of l){h=h.filter(d=>n[3*d]+a[d]>=n[3*u]-a[u]);for(let d of h){if(!o[d]&&!o[u])continue;let f=[0,1,2].map(m=>n[3*d+m]-n[3*u+m]);Ht(f)<a[d]+a[u]&&c.push([d,u])}h.push(u)}return r.length?c:[]}function Bm(i,t,e,n,s,r,o={left:1/0}){let[a,l]=[n,s].map(u=>OS(i.shapes[i.parts.shape[u]])),[c,h]=[n,s].map(u=>Do(i.parts,u,t,e,0));return km(a,c,l,h,r,o)||km(l,h,a,c,r,o)}function km(i,[t,e],n,[s,r],o,a){let[l,c,h,u]=s,d=[-l,-c,-h,u],f=i.corners.map(p=>oi(d,je(Xt(oi(t,p),e),r))),m=i.edges.filter(([p,g])=>[0,1,2].every(y=>Math.max(f[p][y],f[g][y])>n.low[y]+o&&Math.min(f[p][y],f[g][y])<n.high[y]-o));if(a.left-=i.corners.length+m.length*(n.planes||n.triangles).length,a.left<0)return!0;let x=n.planes?kS:zS;return m.some(([p,g])=>x(f[p],f[g],n,o))}function kS(i,t,{planes:e},n){let[s,r]=[0,1];for(let{n:o,d:a}of e){let[l,c]=[Lt(o,i)-a+n,Lt(o,t)-a+n];if(l>=0&&c>=0||(l>0?s=Math.max(s,l/(l-c)):c>0&&(r=Math.min(r,l/(l-c))),s>=r))return!1}return!0}function zS(i,t,e,n){let s=je(t,i),r=[0,1,...Gm(e,(o,a,l)=>VS(i,s,o,a,l))].filter(o=>o!==null).sort((o,a)=>o-a);for(let o=0;o+1<r.length;o+=1)for(let a=0;a<Fm;a+=1){let l=r[o]+(r[o+1]-r[o])*a/(Fm-1);if(GS(Xt(i,Ct(s,l)),e,n))return!0}return!1}function GS(i,t,e){let n=0,s=!1;return Gm(t,(...r)=>{s=s||WS(i,...r)<e,n+=s?0:HS(i,...r)}),!s&&n>2*Math.PI}function Gm({corners:i,triangles:t},e){let n=[];for(let s=0;s<t.length;s+=3)n.push(e(...[0,1,2].map(r=>i[t[s+r]])));return n}function VS(i,t,e,n,s){let r=ce(je(n,e),je(s,e)),o=Lt(r,t);if(o===0)return null;let a=Lt(r,je(e,i))/o;if(!(a>0&&a<1))return null;let l=Xt(i,Ct(t,a));return[[e,n],[n,s],[s,e]].map(([h,u])=>Lt(r,ce(je(u,h),je(l,h)))).every(h=>h>=-1e-9*Lt(r,r))?a:null}function HS(i,...t){let[e,n,s]=t.map(c=>je(c,i)),[r,o,a]=[Ht(e),Ht(n),Ht(s)],l=r*o*a+Lt(e,n)*a+Lt(n,s)*r+Lt(s,e)*o;return 2*Math.atan2(Lt(e,ce(n,s)),l)}function WS(i,t,e,n){let s=ce(je(e,t),je(n,t)),r=[[t,e],[e,n],[n,t]];return r.every(([a,l])=>Lt(s,ce(je(l,a),je(i,a)))>=0)&&Ht(s)>0?Math.abs(Lt(s,je(i,t)))/Ht(s):Math.min(...r.map(([a,l])=>{let c=je(l,a),h=Math.max(0,Math.min(1,Lt(je(i,a),c)/(Lt(c,c)||1)));return Ht(je(i,Xt(a,Ct(c,h))))}))}var XS=["stands","falls","open"];function Vm(i,t,e){let n=!1;for(let s=0,r=i.length-1;s<i.length;r=s,s+=1){let[[o,a],[l,c]]=[i[s],i[r]];a>e!=c>e&&t<(l-o)*(e-a)/(c-a)+o&&(n=!n)}return n}function qS([i,...t],e,n){return Vm(i,e,n)&&!t.some(s=>Vm(s,e,n))}function Hm(i,t,e){for(let n of i)for(let s of XS)if(n[s].some(r=>qS(r,t,e)))return{state:s,height:n.height};return null}var $S={stands:"the box stands",falls:"something falls",open:"open"},sr=class{constructor(t){this.bench=t,this.entered={size:"",mass:""},this.shown=null}controls(t){let e=(l,c,h)=>{let u=document.createElement("input");return u.id=`place-${l}`,u.placeholder=c,u.value=this.entered[l],u.setAttribute("aria-label",h),u.addEventListener("input",()=>this.entered[l]=u.value),u.addEventListener("keydown",d=>{d.key==="Enter"&&(d.preventDefault(),o())}),u},n=this.bench.report?.page.units??"",s=e("size","0.4 0.3 0.25",`length, width and height of the box${n?` [${n}]`:""}`),r=e("mass","6","mass of the box [kg]"),o=()=>{let[l,c]=[cn(Wn(s),3),cn(Wn(r),1)];l&&c?t({size:l,mass:c[0]}):this.bench.complain("Give the size of the box, 3 numbers separated by spaces, and its mass in kg.")},a=document.createElement("span");return a.id="place-state",a.setAttribute("role","status"),[s,r,wt("Map the places",o),a]}tell(t){let e=this.bench.report?.stage;if(!(!e||this.shown===t)){if(this.shown=t,t){this.listen(e);let{center:n,radius:s}=this.bench.report.page;e.places.set(t.data.levels,t.place,n,s)}else e.places.clear();e.draw()}}length(t){return Math.abs(t)<1e-6*this.bench.report.page.radius?"0":t.toPrecision(4)}listen(t){this.heard!==t&&(this.heard=t,t.canvas.addEventListener("pointermove",e=>this.move(e)),t.canvas.addEventListener("pointerleave",()=>this.put(null)))}move(t){if(!this.shown||t.buttons)return;let{stage:e}=this.bench.report,n=e.canvas.getBoundingClientRect(),s=2*(t.clientX-n.left)/n.width-1,r=1-2*(t.clientY-n.top)/n.height;this.put(e.places.under(s,r,e.camera))}put(t){if(!this.shown)return;let{stage:e}=this.bench.report,n=t&&Hm(this.shown.data.levels,...t);e.places.move(t,n),e.draw();let s=document.getElementById("place-state");s&&(s.dataset.state=n?n.state:"",s.textContent=n?`x ${this.length(t[0])}, y ${this.length(t[1])}: ${$S[n.state]}`:"move the pointer over the map")}};var YS={stable:"\u2713",settles:"\u2713","potentially-stable":"\u2248",balanced:"\u25B3",unstable:"\u2715",undecided:"?",unknown:"?"},Wm={stable:"stable",settles:"stable","potentially-stable":"stable",balanced:"stable",unstable:"unstable",undecided:"undecided"},ZS={minimum:"\u25C6 strict minimum",balanced:"\u2715 balanced",open:"\u25C7 open"},JS=3*Math.PI/180,jS=.01,KS="the parts would enter each other at a contact that the motion leaves out",Xm=.2,QS=[1,2,3].flatMap(i=>[i*Math.PI/4,-i*Math.PI/4]).concat(Math.PI),tw=3e3,ew=.75,nw=700,iw=1200,rr=class extends er{constructor(t){super(t),this.down=t.given.down,this.amount=0,this.fell=0,this.shifted=0,this.fallClip=new _o("fall",2,e=>this.fall(e)),this.supportClip=new _o("supports",1,e=>this.shift(e)),this.ball=new hc(b("ball"),t,(e,n,s)=>this.pull(e,n,s)),this.ball.marked=e=>{b("marks-key").hidden=!e.length,b("marks-key").textContent=e.join(", ")},this.ladder=new uc(this),this.look(),this.controls(),this.turn(this.down),this.begin(),t.given.assumption&&this.ladder.tell(t.given.assumption),t.movement&&this.showMovement(t.movement),t.places&&new sr({report:this}).tell({data:t.places,place:t.places.part}),this.stage&&(this.stage.begun=()=>this.reveal(),this.stage.size&&this.reveal())}replace(t){Be(this.down,this.page.given.down)<1e-9&&(this.down=t.given.down),this.painted=void 0,this.changed=!1,this.added=null,this.movement&&this.showMovement(null),this.ball.replace(t),super.replace(t)}renewed(){this.turn(this.down)}reveal(){let t=this.movers(),{stage:e}=this,{parts:n}=e;if(!t.length||t.length===n.count)return;let s=new Set(t),r=()=>{let[c,h]=[e.counted(u=>s.has(u)),e.counted(()=>!0)];return t.reduce((u,d)=>c[d]?Math.min(u,h[d]/c[d]):u,1)};if(r()>=Xm)return;let[o,a]=e.opening,l=n.count>tw||this.page.planar?[]:QS;for(let c of l)if(e.opening=[o,a+c],e.home(),e.scene.updateMatrixWorld(),r()>=Xm)return;e.opening=[o,a],e.home(),b("see-through").value=String(ew),b("see-through-of").value="rest",this.veiled=!0,this.seeThrough(),this.legend()}unveil(){!this.veiled||this.movers().length||(this.veiled=!1,b("see-through").value="0",this.seeThrough(),this.legend(),this.stage.draw())}pull(t,e,n=0){let{region:s,planar:r}=this.page,o=me(t);if(s&&s.dimension&&Ci(s,r)){let a=e==="key"?n/2:JS;No(s,o)<a&&(o=Uu(s,o))}for(let a of[this.page.given,this.page.recommended])a&&Be(a.down,o)<1e-7&&(o=a.down);this.turn(o,{follow:e==="key"})}turn(t,{exactly:e=!1,follow:n=!1}={}){this.down=t;let s=this.found;if(this.found=Cm(this.page,t),(!s||s.fall!==this.found.fall)&&this.showFall(),this.ball.tone=Wm[this.found.verdict],this.ball.set(t,n),this.stage){this.stage.turnTo(t,e),this.stage.places.group.visible=!!this.stage.places.data&&Be(t,this.page.given.down)<1e-9,this.stage.parts.moving.fill(0);for(let r of this.movers())this.stage.parts.moving[r]=1;this.seeThrough()}this.repose(),this.tell()}repose(){if(!this.stage)return;let{parts:t}=this.stage,{motion:e,fall:n}=this.found;this.shifted?this.displace(...this.moved(this.shifted)):n&&n.places?this.fallTo(n):t.pose(e,e&&this.amount?this.amount*this.farthest():0,this.apart),this.stage.ghost.group.visible=!!(this.added&&!(e&&this.amount)&&!this.apart),this.arrows(),this.names.place(),this.stage.draw()}showChange(){let{part:t,shape:e,at:n}=this.page.change;this.changed=!this.changed,b("show-change").setAttribute("aria-pressed",String(this.changed)),t!==null?this.select(this.changed?t:-1):this.stage&&(this.added=this.changed,this.stage.ghost.set(e,n),this.repose())}movers(){if(!this.found)return[];let{moving:t,fall:e}=this.found;return e?e.parts:t||[]}fallTo(t){let{shifts:e,turns:n}=zc(t,this.fell);this.displace(t.parts,e,n)}displace(t,e,n){let{center:s}=this.page.parts,r=l=>[0,1,2].map(c=>this.apart*s[3*l+c]),o=Array.from({length:s.length/3},(l,c)=>r(c)),a=[];t.forEach((l,c)=>{o[l]=o[l].map((h,u)=>h+e[c][u]),a[l]=n[c]}),this.stage.parts.carry(o,a)}showFall(){let{fall:t}=this.found,e=!!(t&&t.places);if(this.fallClip.stop(),this.fell&&(this.fell=0,this.stage.spread(this.spreading())),b("fall").hidden=!e,b("motion-row").hidden=e,!e)return;this.graph=new Uo(b("fall-graph").querySelector("svg"),t,this.page.units);let n=t.words.charAt(0).toUpperCase()+t.words.slice(1);b("fall-words").textContent=`${n}.`,b("fall-friction").textContent=Rd(t),this.fall(0)}fall(t){this.fell=t;let e=zc(this.found.fall,t),n=Gc(this.page.units,e);b("fall-at").value=String(t),b("fall-at").setAttribute("aria-valuetext",n),b("fall-place").textContent=n,this.graph.show(e),this.outside=fr(this.found.fall.parts,this.page.parts,this.page.extent,e.shifts),this.stage&&this.stage.spread(this.spreading()),this.repose()}spreading(){let t=super.spreading();return this.fell||this.movement?t.map((e,n)=>e+this.outside[n]):t}showMovement(t,e=0){this.supportClip.stop(),this.movement=t,b("supports").hidden=!t,t&&(b("supports-words").textContent=t.words),this.shift(e)}shift(t){if(this.shifted=this.movement?t:0,b("supports-at").value=String(this.shifted),this.movement){let[e,n]=this.moved(1);this.outside=fr(e,this.page.parts,this.page.extent,n)}this.stage&&this.stage.spread(this.spreading()),this.repose()}moved(t){let{motion:e}=this.movement,n=Array.from({length:e.length/6},(r,o)=>o),s=r=>[0,1,2].map(o=>t*e[r+o]);return[n,n.map(r=>s(6*r)),n.map(r=>Ji(...s(6*r+3)))]}farthest(){let{found:t,page:e}=this;if(t.farthest===void 0){let n=this.movers().map(r=>e.parts.radius[r]);n.sort((r,o)=>r-o);let s=Lo(t.motion,e.parts.radius,1.1*(n[n.length>>1]||0));t.farthest=zm(e,t.motion,s),t.blocked=t.farthest<jS*s,this.tellMotion()}return t.farthest}tellMotion(){let{motion:t,fall:e,blocked:n}=this.found,s=e?"start of the fall":`motion${n?": blocked":""}`;b("motion-label").textContent=t?s:"motion: none",b("motion-row").title=n?KS:"impending motion"}arrows(){let{stage:t,found:e}=this,n=e.fall?e.fall.begins:e.motion,s=!this.fell&&!this.shifted,r=n&&s&&b("show-motion").checked?this.movers():[],o=this.long*(r.length>20?.5:1);t.motion.set(r.length?Oo(t,n,r,o):{});let a=e.forces?"contact forces":"contact forces: none for this direction",l=e.forces&&s&&b("show-forces").checked;b("show-forces").disabled=!e.forces,b("motion-check").hidden=!n;for(let u of["force-mode-row","thrust-row","size-row"])b(u).hidden=!l;if(b("thrust-key").hidden=!l||!b("show-thrust").checked,t.parts.patches.visible=s&&b("show-contacts").checked,l){let u=this.forceLength()*Number(b("force-size").value),d=b("force-mode").value==="point",{straight:f,most:m,shown:x,all:p}=Fo(t,e.forces,u,d),g=b("show-thrust").checked?Id(t,p,.5*this.long):[];t.forces.set({straight:f,rod:g}),this.shown=x,this.useKey(p),a=`contact forces ${e.forceWords||`up to ${ln(m)} at a point`}`}else t.forces.set({}),this.shown=[],b("use-key").hidden=!0;b("force-label").textContent=a;let c=.018*this.page.radius,h=this.movement?.hinges??[];t.hinges.set({ball:h.map(({part:u,at:d})=>({at:t.parts.placeOf(u,d),along:[0,1,0],size:c}))}),this.paint(),this.marks()}useKey(t){let[e,n]=["use","bond"].map(s=>t.some(r=>r[s]!==null));b("use-key").hidden=!e&&!n,b("use-words").textContent=[...e?["friction"]:[],...n?["bond"]:[]].join(" or ")}seen(){super.seen(),this.tell()}blink(t){if(!this.stage||matchMedia("(prefers-reduced-motion: reduce)").matches)return;let e=n=>{this.blinking=n,this.painted=void 0,this.repose()};e(t),setTimeout(()=>e([]),nw)}paint(){let{stage:t,found:e,page:n}=this;e.bondUse===void 0&&(e.bondUse=Nd(n,e.forces));let s=e.bondUse,r=n.given.assumption?.bodies??[],o={own:null,bond:s,body:r.length?r:null},a=b("colour-of");for(let d of a.options)d.hidden=d.disabled=d.value!=="own"&&!o[d.value];b("colour-row").hidden=!s&&!r.length;let l=o[a.value];if(b("bond-key").hidden=!l||l!==s,b("body-key").hidden=l!==r,b("assumptions").dataset.coloured=String(l===r),l===this.painted)return;this.painted=l;let c=n.parts.colour.slice(),h=qn(document.body),u=d=>f=>c.set(d.map(Math.round),3*f);l===r?r.forEach(({parts:d},f)=>d.forEach(u(Eo(h,f)))):l&&s.forEach((d,f)=>n.parts.grounded[f]||u(So(d,wo(h)))(f)),(this.blinking??[]).forEach(u(Zi(h("unstable")))),t.parts.paint(c)}forceLength(){let{radius:t,parts:e}=this.page,n=e.radius.reduce((s,r,o)=>e.grounded[o]?s:Math.max(s,r),0);return Math.min(.4*t,1.8*n||t)}tell(){let{page:t,found:e}=this,n=b("banner");n.dataset.verdict=e.verdict,b("sign").textContent=YS[e.verdict]||"?",b("verdict").textContent=t.words[e.verdict]||e.verdict,b("sentence").textContent=e.sentence?ji(t,Ad(e.sentence,t.words[e.verdict])):kc(t,e);let s=this.stage?this.movers().filter(d=>!this.stage.parts.visible[d]).length:0,r=[wd(t,e,s)];e.sentence&&r.unshift(kc(t,e)),b("moving").textContent=r.filter(Boolean).join("; "),b("basis").textContent=Ed(t,e),b("down").textContent=Nn(this.down);let o=Be(this.down,t.given.down);b("turned").textContent=o?`turned by ${ai(o)} from the given direction`:"as given";let[a,l]=(e.instability??null)===null?["z",e.z]:["\u03BA",e.instability];b("level").textContent=e.level?`level: ${e.level}`:"",b("figure").title=e.verdict==="undecided"?"for the modelled frictionless contacts alone":"";let c=Wm[e.verdict]!=="stable"&&(l??null)!==null;b("figure").textContent=c?`${a} ${ve(l)}`:"";let h=d=>t[d]&&Be(t[d].down,this.down)<1e-9;b("go-given").setAttribute("aria-pressed",String(!!h("given"))),b("go-recommended").setAttribute("aria-pressed",String(!!h("recommended")));let u=`gravity along ${Nn(this.down,2)}: ${t.words[e.verdict]}`;this.ball.canvas.setAttribute("aria-valuetext",u),this.ball.canvas.setAttribute("aria-valuenow",String(Math.round(o*180/Math.PI)));for(let d of["motion","play"])b(d).hidden=!e.motion;b("motion").disabled=!e.motion,b("go-nearest").hidden=!t.region||!t.region.dimension||cc.includes(e.verdict),this.tellMotion(),this.selected>=0&&this.showPart(this.selected)}controls(){mt("go-given","click",()=>this.turn(this.page.given.down,{exactly:!0,follow:!0})),mt("go-recommended","click",()=>this.turn(this.page.recommended.down,{follow:!0})),mt("go-nearest","click",()=>{this.turn(Uu(this.page.region,this.down),{follow:!0}),b("go-nearest").hidden&&b("ball").focus({preventScroll:!0})}),mt("motion","input",()=>this.slide("amount","motion")),mt("play","click",()=>this.play()),mt("cards","click",e=>e.target.id==="show-change"&&this.showChange()),mt("colour-of","change",()=>this.repose());let{forces:t}=this.page.given;this.stage&&(b("show-forces").checked=!t||t.points.length/3<=iw)}offer(){super.offer();let{page:t}=this,{region:e}=t;b("go-recommended").hidden=t.coincide||!t.recommended,b("go-given").textContent=t.coincide?"Given and recommended":"Given";let n=t.recommended&&cc.includes(t.recommended.verdict);b("go-recommended").textContent=t.recommended&&!n?"Closest to stable":"Recommended";let s=e&&e.outside==="unstable";b("no-map").hidden=!!t.map||!e||!e.equations.length+e.facets.length,b("no-map").dataset.known=String(s),b("no-map-words").textContent=s?"unstable; the degree is not computed for this many parts":"undecided: forces that are not modelled may hold the parts",b("ramp-words").textContent=s?"unstable, from slightly to strongly":"unstable with the frictionless contacts alone, from slightly to strongly",b("ramp").hidden=!t.map||Co(t.map)===0,this.keys();for(let r of this.stage?[]:["fall-play","fall-at","supports-play","supports-at"])b(r).hidden=!0;b("bond-pull").textContent=Sd(t.given.forces&&t.given.forces.pull)}keys(){let{region:t}=this.page;b("question").hidden=!t,b("stable-key").hidden=!t||t.kind==="none",b("gap-key").hidden=!t||!t.inner;let e=new Set((t?.rests??[]).map(({state:n})=>ZS[n]??"\u25CB slides or rolls freely"));b("rests-key").hidden=!e.size,b("rests-key").textContent=[...e].join(" "),t&&(b("question").textContent=t.words.question,b("stable-words").textContent=t.words.inside,t.inner&&(b("gap-words").textContent=Md(t.gap_deg)))}play(){if(this.playing){this.playing=null,b("play").textContent="Play";return}let t=performance.now();this.playing=t,b("play").textContent="Stop";let e=n=>{if(this.playing!==t)return;let s=(n-t)/2600;b("motion").value=String(.5-.5*Math.cos(2*Math.PI*Math.min(s,1))),this.slide("amount","motion"),s<1&&this.found.motion?requestAnimationFrame(e):this.play()};requestAnimationFrame(e)}theme(){super.theme(),this.ball.draw()}ask(t){return this.turn(me(t)),{verdict:b("verdict").textContent,margin:this.found.margin,moving:this.found.moving}}};function pc(i,t){let e=()=>{let n=document.activeElement===t;i.controls.enableZoom=n,t.style.touchAction=n?"none":"pan-y"};t.addEventListener("focus",e),t.addEventListener("blur",e),e()}function or(i,t=document){for(let n of t.querySelectorAll(".text table, .sheet table"))sw(n);let e=new Map;i.parts.tails.forEach((n,s)=>e.set(i.parts.names[s],n));for(let n of t.querySelectorAll(".text .name, #cards .name, .sheet .name")){let s=e.get(n.textContent);s===void 0||s===n.textContent||(n.title=n.textContent,n.textContent=s)}}function sw(i){let t=[...i.querySelectorAll("th")].map(e=>e.textContent);for(let e of i.tBodies[0].rows)[...e.cells].forEach((n,s)=>{t[s]&&(n.dataset.column=t[s])})}var mc=class{constructor(t){this.bench=t,this.asked=!1,mt("open-file","click",()=>this.show(!0)),mt("end-start","click",()=>this.show(!1));for(let n of["files","folder"])mt(n,"change",()=>{this.upload([...b(n).files].map(s=>({file:s,folder:s.webkitRelativePath.split("/").slice(0,-1)[0]||""}))),b(n).value=""});let e=(n,s)=>{[...n.dataTransfer?.types??[]].includes("Files")&&(n.preventDefault(),b("drop").classList.toggle("over",s))};document.addEventListener("dragover",n=>e(n,!0)),document.addEventListener("dragleave",n=>e(n,!1)),document.addEventListener("drop",async n=>{e(n,!1),this.upload(await rw(n.dataTransfer))})}show(t){this.asked=t,this.tell(this.bench.session),t&&b("files").focus()}tell(t){let e=!!t.file;b("start").hidden=e&&!this.asked,b("end-start").hidden=!e,b("open-file").hidden=!e,b("listed-folder").textContent=t.folder,b("listed-title").hidden=!t.files.length,this.list("listed",t.files,"file"),this.list("examples",t.examples,"example");let n=t.recent.filter(({name:s})=>!t.files.includes(s));b("recent-title").hidden=!n.length,this.list("recent",n.map(({path:s})=>s),"recent"),this.feature(t.featured),b("missing").replaceChildren(...t.missing.map(s=>{let r=document.createElement("li");return r.textContent=s,r}))}list(t,e,n){let s=e.join(`
`);b(t).dataset.words!==s&&(b(t).dataset.words=s,b(t).replaceChildren(...e.map(r=>{let o=document.createElement("li");return o.append(wt(r.split("/").pop(),()=>this.open({[n]:r}),n==="recent"?r:"")),o})))}feature(t){b("featured").childElementCount||b("featured").append(...Object.entries(t).map(([e,n])=>{let s=document.createElement("li"),r=wt("",()=>this.open({example:e})),[o,a]=[document.createElement("span"),document.createElement("span")];return o.className="thumbnail",a.textContent=n,r.append(o,a),s.append(r),this.draw(o,e),s}))}async draw(t,e){let n=await fetch(this.bench.link.address(`picture/${e}`));if(!n.ok)return;let s=new DOMParser().parseFromString(await n.text(),"image/svg+xml").documentElement;s.setAttribute("aria-hidden","true"),t.replaceChildren(document.importNode(s,!0))}async open(t){(await this.bench.act({do:"open",...t})).ok&&this.show(!1)}async upload(t){if(!t.length)return;let e=null;for(let[n,{file:s,folder:r}]of t.entries()){b("upload").textContent=`${s.name}: file ${n+1} of ${t.length} is being sent`;let o=r?{name:s.name,folder:r}:{name:s.name};try{let a=await fetch(this.bench.link.address("upload",o),{method:"POST",body:s}),l=await a.json();if(!a.ok)throw new Error(ii(l));e??=l.file}catch(a){b("upload").textContent="",this.bench.complain(`${s.name} was not sent: ${a.message}`);return}}b("upload").textContent="",await this.open({file:e})}},ii=({error:i,hint:t})=>t?`${i}: ${t}`:i;async function rw(i){let t=[...i.items].map(n=>n.webkitGetAsEntry?.()).filter(Boolean);if(!t.length)return[...i.files].map(n=>({file:n,folder:""}));let e=[];for(let n of t)await qm(n,"",e);return e}async function qm(i,t,e){if(i.isFile){let s=await new Promise((r,o)=>i.file(r,o));e.push({file:s,folder:t});return}let n=i.createReader();for(;;){let s=await new Promise((r,o)=>n.readEntries(r,o));if(!s.length)return;for(let r of s)r.isFile&&await qm(r,t||i.name,e)}}var ku=60,gc=class{constructor(t){this.bench=t}tell({open:t,suggestions:e,settle:n}){let{bench:s}=this;Object.assign(this,{offer:n,settling:!1,refusal:""}),this.tellSettle();let r=t.filter(f=>f.decides),o=e.filter(f=>!f.joined),a=o.filter(f=>f.decides);b("decide").hidden=!t.length&&!o.length&&!n,b("decide").classList.toggle("urgent",r.length>0),s.layout.count(r.length+a.length+(n?1:0));let l=f=>this.pair(f,[["Join",()=>s.act({do:"fasten",parts:f.parts,on:!0})]]);ir(b("suggestions"),`Pairs that look fastened (${a.length})`,a.slice(0,ku).map(l),wt("Join all of them",()=>s.act({do:"fasten_suggested",on:!0}),"joins all pairs that look fastened"));let c=(f,m)=>s.act({do:"pair",pairs:f.map(({parts:x})=>x),as:m}),h=f=>this.pair(f,[["Touch",()=>c([f],"touching")],["Apart",()=>c([f],"apart")],["Join",()=>c([f],"joined")]]);ir(b("open-pairs"),`Open pairs (${r.length})`,r.slice(0,ku).map(h),...r.length>1?$m(r,c):[]);let u=t.filter(f=>!f.decides),d=o.filter(f=>!f.decides);ow(b("idle-pairs"),"Pairs that do not change the verdict",[...u.map(h),...d.map(l)],u.length>1?$m(u,c):[])}tellSettle(){let{bench:t,offer:e}=this,n=async()=>{Object.assign(this,{settling:!0,refusal:""}),this.tellSettle(),(await t.act({do:"settle"})).ok||this.refused({error:""})},s=()=>this.settling?Ie("The parts are moved until they rest on each other \u2026",wt("Stop",()=>t.act({do:"stop"}))):Ie(e.parts,wt("Settle",n,"moves the parts by little until they rest on each other; undo takes it back"));ir(b("settle"),"Parts that overlap or hang",e?[s(),...this.refusal?[Ie(this.refusal)]:[]]:[])}refused(t){Object.assign(this,{settling:!1,refusal:t.error?ii(t):""}),this.tellSettle()}pair(t,e){let{bench:n}=this,s=t.parts.map(a=>n.shortName(a)).join(" \u2013 "),r=wt(ji(n.report.page,`${s}: ${t.words}`),()=>n.zoomToNames(t.parts),"show this pair");r.className="link";let o=Ie("",...e.map(([a,l])=>wt(a,l)));return o.firstChild.append(r),o}},$m=(i,t)=>[["All of them touch","touching"],["are apart","apart"],["are joined","joined"]].map(([e,n])=>wt(e,()=>t(i,n)));function ow(i,t,e,n){let s=i.querySelector("details")?.open;if(i.replaceChildren(),!e.length)return;let[r,o,a]=["details","summary","ul"].map(l=>document.createElement(l));r.open=!!s,o.textContent=`${t} (${e.length})`,a.className="entries",a.append(...e.slice(0,ku)),r.append(o,...n,a),i.append(r)}var aw=120,_c=class{constructor(t){this.bench=t,this.start=Date.now(),this.drags=0,mt("friction","input",()=>this.drag(Number(b("friction").value))),mt("friction","change",()=>this.drags+=1),mt("friction-number","change",()=>{let e=b("friction-number").value.trim();this.entered=b("friction-number").value;let n=e===""?null:Nm(e);Number.isNaN(n)?t.complain("Give a coefficient, a share or an angle: 0.3, 30% or 17deg."):t.act({do:"friction",mu:n})}),mt("friction-file","click",()=>t.act({do:"friction",mu:null})),mt("scale-loads","input",()=>b("scale-words").textContent=ve(this.factor(),3)),mt("scale-loads","change",async()=>{let e=this.factor();b("scale-loads").value="0",b("scale-words").textContent="1",e!==1&&await t.act({do:"scale_loads",factor:e})}),mt("floor","change",()=>t.act({do:"floor",on:b("floor").checked})),mt("up","change",()=>t.act({do:"gravity",...b("up").value?{up:b("up").value}:{down:null}})),mt("tilt-form","submit",e=>{e.preventDefault(),this.tilt(Wn(b("tilt")))}),mt("use-gravity","click",()=>{let e=[...t.report.down];t.act({do:"gravity",down:e})})}tilt(t){let{report:e}=this.bench,n={x:"1 0 0",y:"0 1 0",z:"0 0 1"},s=cn(t.replace(/[xyz]/i,a=>n[a.toLowerCase()]),4)??cn(t,3);if(!s||!Ht(s.slice(-3))){this.bench.complain("Give an angle in degrees and an axis, as 10 x, or a direction of gravity of three numbers.");return}let[r,o]=[me(s.slice(-3)),s.length===4?s[0]:null];e.pull(o===null?r:Po(e.page.given.down,r,-o*Math.PI/180),"typed")}factor(){return Number((10**Number(b("scale-loads").value)).toPrecision(3))}drag(t){if(b("friction-number").value=String(t),this.wanted=t,this.sending)return;this.sending=!0;let e=async()=>{let n=this.wanted;this.wanted=null,await this.bench.act({do:"friction",mu:n,live:`${this.start}-${this.drags}`}),setTimeout(()=>{this.wanted!==null?e():this.sending=!1},aw)};e()}tell({choices:t}){let{bench:e}=this,{friction:n,floor:s,up:r}=t,o=n!==void 0;if(!this.sending){let a=e.report?.page.friction;b("friction").value=String(n??a??0),document.activeElement===b("friction-number")&&b("friction-number").value!==this.entered||(b("friction-number").value=o?String(n):""),b("friction-number").placeholder=a===void 0?"file":String(a)}b("friction-file").hidden=!o,b("floor").checked=!!s,b("up").value=r??"",this.lists(t)}lists(t){let{bench:e}=this,n=a=>e.shortName(a),s=t.loads??[];b("scale-row").hidden=!s.length,Hn(b("loads"),...s.map((a,l)=>{let c=Math.hypot(...a.force),h=`load ${l+1}: ${ln(c)} along ${Nn(a.force.map(d=>d/(c||1)),3)} on ${n(a.part)}`,u=wt("Edit",()=>e.parts.editLoad(a,l));return Ie(h,u,wt("Remove",()=>e.act({do:"load_off",index:l})))}));let r=({parts:a})=>a.map(n).join(" and "),o=[...(t.joined??[]).map(a=>Ie(`joined: ${a.map(n).join(" and ")}`,wt("Remove",()=>e.act({do:"fasten",parts:a,on:!1})))),...(t.open_pairs??[]).map(a=>Ie(`${a.as}: ${r(a)}`,wt("Remove",()=>e.act({do:"pair",pairs:[a.parts],as:null})))),...(t.joints??[]).map((a,l)=>Ie(`${a.kind} joint: ${r(a)}`,wt("Remove",()=>e.act({do:"joint_off",index:l})))),...(t.bonds??[]).map((a,l)=>Ie(`bond of ${ln(a.pull)} per point: ${r(a)}`,wt("Remove",()=>e.act({do:"bond_off",index:l})))),...(t.straps??[]).map((a,l)=>Ie(`strap of ${ln(a.tension)}: ${a.path.map(([c])=>n(c)).join(", ")}`,wt("Remove",()=>e.act({do:"strap_off",index:l})))),...(t.friction_pairs??[]).map(a=>Ie(`friction ${a.mu}: ${r(a)}`,wt("Remove",()=>e.act({do:"pair_friction",parts:a.parts,mu:null})))),...t.poses?[Ie(`moved: ${Object.keys(t.poses).map(n).join(", ")}`,wt("Remove",()=>e.act({do:"poses",poses:null}),"places these parts as in the file"))]:[],...["fasten_suggested","fasten_overlaps","loose"].filter(a=>t[a]).map(a=>Ie(lw[a],wt("Remove",()=>e.act({do:a,on:!1}))))];Hn(b("joined"),...o)}},lw={fasten_suggested:"joined: all pairs that look fastened",fasten_overlaps:"joined: all pairs that overlap",loose:"loose tolerances"};var Ym=[300,600,1200,2500,5e3],xc=class{constructor(t,e,n){Object.assign(this,{token:t,hear:e,change:n,opened:!1,number:0,waiting:new Map,failed:0}),this.connect()}address(t,e={}){let n=new URL(location.href);return n.hash="",n.pathname+=n.pathname.endsWith("/")?t:`/${t}`,n.search=new URLSearchParams({token:this.token,...e}).toString(),n}connect(){let t=this.address("live");t.protocol=t.protocol==="https:"?"wss:":"ws:";let e=new WebSocket(t);this.socket=e,e.addEventListener("open",()=>{this.failed=0,this.opened=!0,this.change(!0)}),e.addEventListener("message",n=>this.take(JSON.parse(n.data))),e.addEventListener("close",()=>this.lost())}lost(){for(let e of this.waiting.values())e({ok:!1,error:"the connection was lost",hint:""});this.waiting.clear(),this.change(!1);let t=Ym[Math.min(this.failed,Ym.length-1)];this.failed+=1,setTimeout(()=>this.connect(),t)}take(t){if(!("re"in t)){this.hear(t);return}let e=this.waiting.get(t.re);this.waiting.delete(t.re),e&&e(t)}send(t){if(this.socket.readyState!==WebSocket.OPEN)return Promise.resolve({ok:!1,error:"there is no connection to kilter",hint:"the page tries to connect again"});this.number+=1;let e=this.number;return this.socket.send(JSON.stringify({id:e,...t})),new Promise(n=>this.waiting.set(e,n))}};var cw=[["h","hold or release the selected parts"],["x, Delete","leave out the selected parts"],["j","join two selected parts, or the selected part with the next one that is clicked"],["f","fit the view to the selected parts, or to all"],["v, i, a","hide, show alone, show all"],["n, p","next part, previous part"],["m","measure"],["1 to 7, 0, o","standard views, first view, view without perspective"],["Ctrl+Z, Ctrl+Y, Ctrl+S","undo, redo, save"],["Escape","end measuring or joining, select nothing"],["?","this help"]],xo=[["#banner","The answer","The verdict with its reason, and the row of assumptions: the parts as drawn, with their play, with fastened pairs, or all joined."],[".stage","The picture","Parts that move have a coloured outline and an arrow. Click a part to act on it; drag to turn the view."],["#part-card","The parts","Search, hide and select parts; below are the facts of the selected part, its material, mass and loads."],["#panel-list","Your decisions","Questions that change the verdict, the direction of gravity, friction and loads, and the display."],["#tabs","Your questions","Which way up, how far it may tilt, in which order it can be built, which parts to hold. Each answer has its command line."]],hw="Each command explains itself: kilter --help, kilter check --help. A terminal prints these pages by kilter help.",vc=class{constructor(t,e){this.dialog=hn("dialog","",{id:"help","aria-label":"help"});let n=hn("dl","");for(let[c,h]of cw)n.append(hn("dt",c),hn("dd",h));let s=wt("Close",()=>this.dialog.close()),r=wt("Show the tour",()=>this.step(0)),o=hn("div","",{class:"buttons"});o.append(r,s);let a=hn("ul","",{class:"guides"});for(let[c,h]of t){let u=hn("li","");u.append(hn("a",h,{href:e(`guide/${c}`),target:"_blank",rel:"noopener"})),a.append(u)}let l=t.length?[hn("h2","Guides"),a]:[];this.dialog.append(hn("h2","Keys"),n,...l,hn("p",hw,{class:"small"}),o),this.card=hn("div","",{id:"tour",role:"dialog","aria-label":"tour",hidden:""}),document.body.append(this.dialog,this.card)}show(){this.dialog.showModal()}step(t){if(this.dialog.open&&this.dialog.close(),document.querySelector(".toured")?.classList.remove("toured"),this.card.hidden=t>=xo.length,this.card.hidden)return;let[e,n,s]=xo[t],r=document.querySelector(e);r.classList.add("toured");let o=wt(t+1<xo.length?`Next (${t+1} of ${xo.length})`:"Done",()=>this.step(t+1)),a=hn("div","",{class:"buttons"});a.append(o,wt("End the tour",()=>this.step(xo.length))),this.card.replaceChildren(hn("h2",n),hn("p",s),a);let l=r.getBoundingClientRect(),{offsetWidth:c,offsetHeight:h}=this.card,u=l.left+c+24<innerWidth/2+l.width?l.right-c-16:l.left-c-16;this.card.style.left=`${Math.max(8,Math.min(innerWidth-c-8,u))}px`,this.card.style.top=`${Math.max(8,Math.min(innerHeight-h-8,l.top+24))}px`,o.focus()}};function hn(i,t,e={}){let n=document.createElement(i);n.textContent=t;for(let[s,r]of Object.entries(e))n.setAttribute(s,r);return n}var uw={answer:["Answer",["assumptions","decide","left-out-card","answer-title"]],gravity:["Gravity",["tilt","ball"]],forces:["Friction, loads",["friction"]],display:["Display",["explode"]]},dw=24,fw={left:{label:"width of the list of parts",panel:".parts-column",least:170,most:520,sign:1,upright:!0},right:{label:"width of the panels",panel:"aside",least:280,most:640,sign:-1,upright:!0},sheet:{label:"height of the analysis",panel:"#sheet",least:120,most:640,sign:-1,upright:!1}},yc=class{constructor(){this.now="answer";let t=document.querySelector(".columns"),e=document.querySelector("aside"),n=document.createElement("div");n.className="parts-column",n.append(b("part-card")),t.insertBefore(n,t.querySelector(".left").nextSibling),this.list=document.createElement("div"),this.list.id="panel-list",this.list.setAttribute("role","tablist"),this.list.setAttribute("aria-label","panels"),this.buttons=Object.entries(uw).map(([s,[r,o]])=>this.panel(e,s,r,o)),this.list.append(...this.buttons),e.prepend(this.list),b("cards").hidden=!0,this.list.addEventListener("keydown",s=>zu(this.buttons,s));for(let s of["left","right"])t.append(Zm(s));b("tabs").prepend(Zm("sheet")),this.show("answer"),this.opened=()=>{}}panel(t,e,n,s){let r=document.createElement("div");r.id=`panel-${e}`,r.className="panel",r.setAttribute("role","tabpanel"),r.setAttribute("aria-labelledby",`open-${e}`),r.append(...s.map(a=>b(a).closest("section"))),t.append(r);let o=wt(n,()=>this.show(e));return o.id=`open-${e}`,o.dataset.panel=e,o.setAttribute("role","tab"),o.setAttribute("aria-controls",r.id),o}show(t){this.now=t;for(let e of this.buttons){let n=e.dataset.panel===t;e.setAttribute("aria-selected",String(n)),e.tabIndex=n?0:-1,b(`panel-${e.dataset.panel}`).hidden=!n}this.opened?.(t)}count(t){this.buttons[0].textContent=t?`Answer (${t})`:"Answer",b("panel-answer").dataset.empty=String(!t)}};function zu(i,t){let e=i.indexOf(t.target),n=i.length-1,s={ArrowRight:e===n?0:e+1,ArrowLeft:e?e-1:n,Home:0,End:n}[t.key];e<0||s===void 0||(t.preventDefault(),i.forEach((r,o)=>r.tabIndex=o===s?0:-1),i[s].focus())}function Zm(i){let{label:t,panel:e,least:n,most:s,sign:r,upright:o}=fw[i],a=document.createElement("div");a.id=`edge-${i}`,a.className="edge",a.tabIndex=0;let l={role:"separator","aria-label":t,"aria-orientation":o?"vertical":"horizontal","aria-valuemin":n,"aria-valuemax":s};for(let[f,m]of Object.entries(l))a.setAttribute(f,String(m));let c=`--${i}`,h=()=>document.querySelector(e)[o?"offsetWidth":"offsetHeight"],u=f=>{let m=Math.round(Math.max(n,Math.min(s,f)));document.body.style.setProperty(c,`${m}px`),a.setAttribute("aria-valuenow",String(m))};a.setAttribute("aria-valuenow",String(Math.max(n,h()))),a.addEventListener("focus",()=>a.setAttribute("aria-valuenow",String(Math.max(n,h()))));let d=null;a.addEventListener("pointerdown",f=>{a.setPointerCapture(f.pointerId),d=[o?f.clientX:f.clientY,h()],f.preventDefault()}),a.addEventListener("pointermove",f=>d&&u(d[1]+r*((o?f.clientX:f.clientY)-d[0])));for(let f of["pointerup","pointercancel"])a.addEventListener(f,()=>d=null);return a.addEventListener("keydown",f=>{let m={ArrowRight:o?1:0,ArrowLeft:o?-1:0,ArrowDown:o?0:1,ArrowUp:o?0:-1}[f.key];m&&(f.preventDefault(),u(h()+r*m*dw))}),a}var pw=12,Jm=3,bc=class{constructor(t,e){Object.assign(this,{bench:t,canvas:e,taken:null}),e.addEventListener("pointerdown",n=>this.press(n),{capture:!0}),e.addEventListener("pointermove",n=>this.move(n),{capture:!0}),e.addEventListener("pointerup",n=>this.release(n),{capture:!0}),e.addEventListener("pointercancel",()=>this.drop())}place(t){let e=this.canvas.getBoundingClientRect();return[t.clientX-e.left,t.clientY-e.top]}arrows(){let{report:t,session:e}=this.bench,{loads:n}=t.page,s=e.choices.loads??[],r=n.length-s.length,o=t.loadScale();return n.slice(r).map((a,l)=>{let c=t.stage.parts.placeOf(a.part,a.point);return{load:a,index:l,from:c,tip:Xt(c,Ct(a.force,o))}})}press(t){if(t.button||t.shiftKey||this.bench.report.measure.on)return;let{stage:e}=this.bench.report,[n,s]=this.place(t),r=({tip:l})=>{let c=e.onScreen(l);return c?Math.hypot(c[0]-n,c[1]-s):1/0},[o]=this.arrows().sort((l,c)=>r(l)-r(c));if(!o||r(o)>pw)return;t.stopImmediatePropagation(),this.canvas.setPointerCapture(t.pointerId);let a=this.bench.report.loadScale();this.bench.report.fixedScale=a,this.taken={...o,scale:a,force:[...o.load.force],moved:!1}}move(t){if(!this.taken)return;t.stopImmediatePropagation();let{report:e}=this.bench,{load:n,from:s,tip:r,scale:o}=this.taken,a=e.stage.underPlane(this.place(t),r),l=Ct(Xt(a,Ct(s,-1)),1/o),c=10**(Math.floor(Math.log10(Ht(l)||1))+1-Jm);this.taken.force=l.map(h=>Number((Math.round(h/c)*c).toPrecision(Jm+3))),this.taken.moved=!0,n.force=this.taken.force,e.repose()}drop(){this.taken=null,this.bench.report.fixedScale=0}release(t){if(!this.taken)return;t.stopImmediatePropagation();let{index:e,force:n,moved:s}=this.taken;if(this.drop(),!s||!Ht(n))return;let r=this.bench.session.choices.loads[e];this.bench.act({...r,do:"load",force:n,index:e})}};var jm=(i,t,e)=>({down:t,verdict:"unknown",sentence:"",level:null,moves:new Uint8Array(i),motion:null,words:{},forces:null,force_words:"",fall:null,assumption:e?.moves.length===i?e.assumption:null}),Gu={grip:" part that is changed",hand:" movement of a part",added:" part after the change"},Mc=class extends rr{answered(t){let e=Be(this.down,this.page.given.down)<1e-9,n=!!t.assumption;t.assumption??=this.page.given.assumption,this.page.given=t,this.page.probed=null,this.found=null,this.painted=void 0,this.offer(),this.turn(e?t.down:this.down),n&&this.ladder.tell(t.assumption)}restart(t){if(this.select(-1),this.ladder.tell(null),this.stage){this.stage.parts.visible.fill(1);for(let e of["explode","see-through","motion"])b(e).value="0";[this.apart,this.amount]=[0,0]}this.down=this.page.given.down,this.replace(t),this.stage&&this.stage.home()}showDirections(t){let e={recommended:null,region:null,rays:null,map:null,coincide:!1};Object.assign(this.page,e,t??{},{probed:null}),this.ball.replace(this.page),this.found=null,this.offer(),this.turn(this.down)}showProbe(t){this.page.probed=t,!(Be(t.down,this.down)>1e-7)&&(this.down=t.down,this.turn(t.down))}pull(t,e,n){super.pull(t,e,n),this.found.from==="none"&&this.unknown?.(this.down)}turn(t,e){super.turn(t,e);let{stage:n,limit:s}=this;if(!(!n||!s)){this.found={...this.found,motion:s.motion,moving:s.moving,forces:null,fall:null,words:null,farthest:void 0},s.down&&n.turnTo(s.down),n.parts.moving.fill(0);for(let r of s.moving)n.parts.moving[r]=1;n.parts.states(),this.seeThrough(),this.tellMotion(),this.repose()}}showLimit(t){this.limit=t,this.added=!!t?.ghost,this.added&&this.stage.ghost.set(t.ghost,[0,0,0],!0),this.found=null,this.turn(this.down);for(let e of["motion","play"])b(e).hidden=!this.found.motion;b("motion").disabled=!this.found.motion}showFilm(t){this.film=t,this.filmTime=0,!(t||!this.stage)&&(this.stage.parts.present.fill(1),this.stage.parts.gripped.fill(0),this.found=null,this.turn(this.down),this.stage.parts.states())}repose(){let{film:t,stage:e}=this;if(!t||!e){super.repose();return}t.place(this.filmTime),t.arrows(this.filmTime),this.marks(),this.names.place(),e.draw()}arrows(){super.arrows();let{stage:t,limit:e}=this,n=({part:s,point:r,along:o})=>({at:r?t.parts.placeOf(s,r):t.parts.centre(s),along:o,size:1.3*this.long,wide:1.3*this.long});t.hands.set({straight:(e?.pushes??[]).map(n)}),this.legend()}legend(){if(super.legend(),!this.stage)return;this.keys??=Object.fromEntries(Object.keys(Gu).map(e=>[e,b(`${e}-key`).lastChild.data]));let t=this.limit?.changes?Gu:this.keys;for(let e of Object.keys(Gu))b(`${e}-key`).lastChild.data=t[e]}tell(){super.tell();let t=Be(this.down,this.page.given.down)>1e-9,e=this.found.from!=="none";this.found.from==="probed"&&(b("level").textContent="equilibrium"),b("use-gravity").hidden=!t,e||(b("verdict").textContent="Not analysed",b("sentence").textContent="Use this direction of gravity to analyse it, or return to the given direction.",b("moving").textContent=""),this.told&&this.told()}showSelection(){super.showSelection(),this.selected_&&this.selected_()}};function Km(i){return i.tails=bo(i.names),i.full_names??=i.names,i}var Vu=(i,t)=>[i[3*t],i[3*t+1],i[3*t+2]],Hu=.001;function Qm(i,[t,e]){let{parts:n,start:s,points:r,normals:o,normal:a}=i.patches,l=[];for(let w=0;w+1<s.length;w+=1){let[S,T]=[n[2*w],n[2*w+1]];if(S===t&&T===e||S===e&&T===t)for(let A=s[w];A<s[w+1];A+=1)l.push({at:Vu(r,A),n:o?Vu(o,A):Vu(a,w)})}if(!l.length)return{point:null,axis:null};let c=Ct(l.reduce((w,{at:S})=>Xt(w,S),[0,0,0]),1/l.length),h=w=>Xt(w,i.center),u=l.reduce((w,{n:S})=>{let T=ce(l[0].n,S);return Xt(w,Ct(T,Lt(T,w)<0?-1:1))},[0,0,0]);if(Ht(u)<Hu)return{point:h(c),axis:null};let d=me(u);if(l.some(({n:w})=>Math.abs(Lt(w,d))>Hu))return{point:h(c),axis:null};let[f,m]=[l[0],l.find(({n:w})=>Ht(ce(l[0].n,w))>Hu)],x=Xt(m.at,Ct(f.at,-1)),p=ce(m.n,d),g=Lt(x,p)/Lt(f.n,p),y=Xt(f.at,Ct(f.n,g));return{point:h(Xt(y,Ct(d,Lt(Xt(c,Ct(y,-1)),d)))),axis:d}}var tg=["revolute","cylindrical","spherical"],mw=1e-6,eg=["revolute","cylindrical","prismatic"],Sc=class{constructor(t){this.bench=t,this.edited=null;let e=()=>this.names();mt("do-hold","click",()=>this.hold()),mt("do-leave-out","click",()=>this.leaveOut()),mt("do-material","change",()=>this.material()),this.form("density-form","do-density",1,([n])=>({do:"material",parts:e(),density:n})),this.form("mass-form","do-mass",1,([n])=>({do:"mass",part:e()[0],mass:n})),this.form("load-form","do-load",3,n=>{let{index:s,load:r}=this.edited??{};return this.edited=null,s===void 0?{do:"load",part:e()[0],force:n}:{...r,do:"load",force:n,index:s}}),this.form("move-form","do-move",3,n=>t.tabs.moveSupport(e()[0],n)),mt("do-join","click",()=>this.join());for(let[n,s]of[["do-touching","touching"],["do-apart","apart"],["do-undecided",null]])mt(n,"click",()=>t.act({do:"pair",pairs:[e()],as:s}));this.form("pair-friction-form","do-pair-friction",1,([n])=>({do:"pair_friction",parts:e(),mu:n})),this.form("bond-form","do-bond",1,([n])=>({do:"bond",parts:e(),pull:n,shear:null})),mt("do-joint","change",()=>this.jointRows()),mt("joint-form","submit",n=>{n.preventDefault(),this.joint()})}form(t,e,n,s){mt(t,"submit",r=>{r.preventDefault();let o=cn(b(e).value,n),a=o&&s(o);a?this.bench.act(a):o||this.bench.complain(n>1?`Give ${n} numbers, separated by spaces.`:"Give a number.")})}hold(){return this.bench.act({do:"hold",parts:this.names(),on:!this.allHeld()})}leaveOut(){return this.bench.act({do:"leave_out",parts:this.names(),on:!0})}join(){return this.bench.act({do:"fasten",parts:this.names(),on:!0})}names(){let{report:t}=this.bench;return[...t.selection].map(e=>t.page.parts.full_names[e])}allHeld(){let{report:t}=this.bench;return[...t.selection].every(e=>t.page.parts.grounded[e])}tell(){let{report:t,session:e}=this.bench,n=[...t.selection];if(!n.length)return;let{parts:s}=t.page,r=new Set(n.map(l=>s.held_by?.[l])),o=r.has("file")||r.has("floor")||r.has("assumed");b("do-hold").textContent=this.allHeld()?"Release":"Hold",b("do-hold").hidden=this.allHeld()&&o,b("hold-note").hidden=!o,b("hold-note").textContent=r.has("floor")?"The floor is held, and can be switched off below.":r.has("assumed")?"A floor is assumed, since nothing is held: hold a part instead.":"The file itself holds this part.",b("do-leave-out").hidden=r.has("floor")||r.has("assumed");let a=n.length===1;for(let l of["mass-form","load-form"])b(l).hidden=!a||s.grounded[n[0]];b("move-form").hidden=!a||!s.grounded[n[0]]||r.has("assumed"),b("pair-actions").hidden=n.length!==2,this.materials(e.materials),this.busy("density-form")||(b("do-density").value=a&&s.density?.[n[0]]?ve(s.density[n[0]],6):""),this.busy("mass-form")||(b("do-mass").value=a?ve(s.mass[n[0]],6):""),n.length===2&&this.suggestJoint(n),this.jointRows()}busy(t){return b(t).contains(document.activeElement)}materials(t){let e=b("do-material");e.options.length!==t.length+2&&e.replaceChildren(new Option("choose\u2026",""),...t.map(({name:a,density:l,source:c})=>{let h=new Option(`${a}, ${l} kg/m\xB3`,a);return h.title=c,h}),new Option("as in the file","file"));let{report:n,session:s}=this.bench,r=new Map((s.choices.materials??[]).map(a=>[a.parts,a.name])),o=new Set([...n.selection].map(a=>r.get(n.page.parts.full_names[a])??""));e.value=o.size===1?[...o][0]:""}material(){let t=b("do-material").value;if(!t)return;let e=this.bench.session.materials.find(n=>n.name===t);this.bench.act({do:"material",parts:this.names(),density:e?.density??null,name:e?.name??null})}editLoad(t,e){let{report:n}=this.bench,s=n.page.parts.full_names.indexOf(t.part);s>=0&&n.select(s),this.edited={index:e,load:t},b("do-load").value=t.force.join(" "),b("do-load").focus()}suggestJoint(t){let e=t.join();if(this.suggested===e)return;this.suggested=e;let n=Qm(this.bench.report.page,t),{radius:s}=this.bench.report.page,r=(o,a)=>o?o.map(l=>Math.abs(l)<mw*a?"0":ve(l,6)).join(" "):"";b("joint-point").value=r(n.point,s),b("joint-axis").value=r(n.axis,1),n.axis&&(b("do-joint").value="revolute")}jointRows(){let t=b("do-joint").value;b("joint-point-row").hidden=!tg.includes(t),b("joint-axis-row").hidden=!eg.includes(t)}joint(){let t=b("do-joint").value,e={do:"joint",parts:this.names(),kind:t};for(let[n,s]of[[tg,"point"],[eg,"axis"]])if(n.includes(t)&&(e[s]=cn(b(`joint-${s}`).value,3),!e[s])){this.bench.complain(`Give the ${s} of the joint: 3 numbers, separated by spaces.`);return}this.bench.act(e)}tellLeftOut(t){b("left-out-card").hidden=!t.length,Hn(b("left-out"),...t.map(e=>Ie(this.bench.shortName(e),wt("Bring back",()=>this.bench.act({do:"leave_out",parts:[e],on:!1})))))}};var Wu=2,gw=30,ng=6e3,_w=400,xw=["video/mp4","video/webm"];function ig(i){let[t,e]=i.size,n=document.createElement("canvas");Object.assign(n,{width:Wu*t,height:Wu*e});let s=n.cloneNode();i.shootInto(s,i.camera,Wu);let r=n.getContext("2d");return r.fillStyle=getComputedStyle(document.body).getPropertyValue("--surface"),r.fillRect(0,0,n.width,n.height),r.drawImage(s,0,0),new Promise(o=>n.toBlob(o,"image/png"))}async function sg(i){if(!window.MediaRecorder)throw new Error("this browser records no video");let t=xw.find(r=>MediaRecorder.isTypeSupported(r)),e=new MediaRecorder(b("picture").captureStream(gw),{mimeType:t}),n=[];e.addEventListener("dataavailable",r=>n.push(r.data));let s=new Promise(r=>e.addEventListener("stop",r));return e.start(),await vw(i),await new Promise(r=>setTimeout(r,_w)),e.stop(),await s,[new Blob(n,{type:t}),t.split("/")[1]]}async function vw({report:i,tabs:t}){let{onStage:e}=t;if(i.film)e.go(0),e.play(),await wc(()=>!e.playing);else if(i.found.fall?.places)i.fall(0),i.fallClip.play(),await wc(()=>!i.fallClip.playing);else if(i.found.motion)i.play(),await wc(()=>!i.playing);else{let n=performance.now(),s=n+ng;await wc(r=>(i.stage.orbit(2*Math.PI*(r-n)/ng,0),n=r,r>=s))}}var wc=i=>new Promise(t=>{let e=n=>i(n)?t():requestAnimationFrame(e);requestAnimationFrame(e)});var yw=4,ar=8,rg=22,Ec=class{constructor(t){Object.assign(this,{bench:t,joining:-1,pinned:null});let{report:e,parts:n}=t;this.box=document.createElement("div"),this.box.id="selected-bar",this.box.setAttribute("role","toolbar"),this.box.setAttribute("aria-label","selected parts"),this.hold=wt("Hold",()=>n.hold(),"hold or release (h)"),this.join=wt("Join with\u2026",()=>this.startJoin(),"join with a part that you click next (j)"),this.leave=wt("Leave out",()=>n.leaveOut(),"leave out (x)"),this.material=wt("Material\u2026",()=>b("do-material").focus(),"material, density, mass and load"),this.box.append(this.hold,this.join,this.leave,this.material,wt("Hide others",()=>e.isolate(),"show the selected parts alone (i); a shows all")),b("picture").parentElement.append(this.box),this.listen(b("picture")),this.tell()}listen(t){let e=null;t.addEventListener("pointerdown",n=>{e=[n.clientX,n.clientY],this.pinned=null,this.place()}),t.addEventListener("contextmenu",n=>{if(n.preventDefault(),!e||Math.hypot(n.clientX-e[0],n.clientY-e[1])>=yw)return;let{report:s}=this.bench,r=t.getBoundingClientRect(),o=[n.clientX-r.left,n.clientY-r.top],a=s.stage.pick(...o);a<0||(this.pinned=o,s.selection.has(a)?this.place():s.select(a))})}startJoin(){let{report:t,parts:e}=this.bench;if(t.selection.size>1){e.join();return}this.joining=t.selected,this.box.hidden=!0,this.bench.note(`Click the part to join with ${t.page.parts.tails[this.joining]}; Escape ends this.`,!1)}takeSecond(){let{report:t}=this.bench,e=this.joining;e<0||t.selected===e||(this.joining=-1,this.bench.note(""),t.selection.size===1&&(t.choose([e,t.selected]),this.bench.parts.join()))}tell(){let{report:t}=this.bench;this.takeSecond(),this.box.hidden=!t.selection.size||this.joining>=0,!this.box.hidden&&(this.hold.textContent=b("do-hold").textContent,this.hold.hidden=b("do-hold").hidden,this.leave.hidden=b("do-leave-out").hidden,this.join.hidden=t.selection.size>2,this.join.textContent=t.selection.size===2?"Join":"Join with\u2026",this.place())}place(){if(this.box.hidden)return;let{stage:t,selected:e}=this.bench.report,n=this.pinned??(t.parts.shown(e)?t.onScreen(t.parts.centre(e)):null),{offsetWidth:s,offsetHeight:r}=this.box,[o,a]=t.size,[l,c]=n??[ar,a],h=this.pinned?rg:Math.max(rg,t.sizeOnScreen(e)),u=Math.max(ar,Math.min(o-s-ar,l-s/2)),d=c-h-r>ar,f=Math.max(ar,Math.min(a-r-ar,d?c-h-r:c+h));this.box.style.transform=`translate(${Math.round(u)}px, ${Math.round(f)}px)`}};var bw=1250,Mw=300,Xu="",Ac=class{constructor(t){Object.assign(this,{bench:t,shown:null,strip:null,cases:[],changed:null})}tell(t,e){let{report:n}=this.bench;!n?.stage||this.shown===e||(this.clear(),this.shown=e,!(!e||e.error)&&(t==="plan"&&e.film?.steps.length&&this.begin(e.film),t==="margin"&&(this.cases=Sw(e.data,this.bench)),t==="transport"&&(this.cases=ww(e.data)),t==="supports"&&e.movement&&n.showMovement(e.movement,1),t==="hold"&&this.support(e.data.supports??[]),t==="helps"&&e.changes.length===1&&this.change(0,e.changes)))}clear(){let{report:t}=this.bench;this.pause(),this.strip=null,this.cases=[],this.changed=null,t.stage.parts.gripped.fill(0),t.film&&(t.showFilm(null),t.stage.home()),t.movement&&t.showMovement(null),t.limit?t.showLimit(null):this.shown&&t.turn(t.down)}controls(){if(this.strip)return this.playButton=wt(this.playing?"Pause":"Play",()=>this.playing?this.pause():this.play()),[wt("Back",()=>this.jump(-1),"previous step"),this.playButton,wt("Forward",()=>this.jump(1),"next step")];if(!this.cases.length)return[];let t=document.createElement("select");return t.id="limit-case",t.setAttribute("aria-label","limit that the picture shows"),t.add(new Option("show in the picture\u2026",Xu)),this.cases.slice(0,Mw).forEach(({label:e},n)=>t.add(new Option(e,String(n)))),t.value=this.chosen??Xu,t.addEventListener("change",()=>this.choose(t.value)),[t]}get content(){return this.strip?[this.list]:[]}choose(t){let{report:e}=this.bench;this.chosen=t;let n=this.cases[Number(t)];if(t===Xu||!n){e.showLimit(null);return}let{full_names:s,radius:r,grounded:o}=e.page.parts,a=new Float32Array(6*s.length);s.forEach((u,d)=>n.mechanism?.[u]&&a.set(n.mechanism[u],6*d));let l=Ro(a,r),c=n.part===void 0?o.findIndex(Boolean):s.indexOf(n.part),h=n.along&&c>=0?[{part:c,along:n.along}]:[];e.showLimit({motion:l.length?a:null,moving:l,down:n.down,pushes:h})}support(t){let{full_names:e}=this.bench.report.page.parts,{center:n}=this.bench.report.page,s=t.filter(({kind:o})=>o==="grip").map(({part:o})=>e.indexOf(o)),r=t.filter(({direction:o,part:a})=>o&&e.includes(a)).map(({part:o,point:a,direction:l})=>({part:e.indexOf(o),point:a&&a.map((c,h)=>c-n[h]),along:l}));this.mark(s,{pushes:r})}mark(t,e){let{report:n}=this.bench,{gripped:s}=n.stage.parts;s.fill(0);for(let r of t)s[r]=1;n.showLimit({motion:null,moving:[],...e})}change(t,e){if(!this.bench.report?.stage)return;let n=this.changed===t;if(this.clear(),n)return;this.changed=t;let{parts:s,pushes:r,ghost:o}=e[t];this.mark(s,{pushes:r,ghost:o,changes:!0})}begin(t){let{report:e}=this.bench,n=new ms(e,t);e.showFilm(n);let s=n.overhang();e.stage.spread(e.page.extent.map((o,a)=>o+s[a])),this.list=document.createElement("ol"),this.list.id="film-strip",this.list.className="strip";let r=(o,a)=>{n.paint(o,a),e.repose()};this.strip=new nr(this.list,{plan:t,parts:e.page.parts},o=>this.go(n.pictureAt(o)),r),this.go(n.pictureAt(0))}go(t,e=!0){let{report:n}=this.bench,{film:s}=n;e&&this.pause(),n.filmTime=Math.max(0,Math.min(s.count,t));let[r]=s.stepAt(n.filmTime);this.strip.mark(r),n.stage.turnTo(s.plan.steps[r].down),n.repose()}jump(t){let{report:e}=this.bench;this.go(e.film.jumped(e.filmTime,t))}play(){let{report:t}=this.bench,[e,n]=[performance.now(),t.filmTime>=t.film.count?0:t.filmTime];this.playing=e,this.playButton.textContent="Pause";let s=r=>{if(this.playing!==e||!t.film)return;let o=n+Math.max(0,r-e)/bw;this.go(o,!1),o<t.film.count?requestAnimationFrame(s):this.pause()};requestAnimationFrame(s)}pause(){this.playing=null,this.playButton&&(this.playButton.textContent="Play")}};function Sw(i,t){let e=[];i.tilt_limit?.mechanism&&e.push({label:`tilt by ${ai(i.tilt_deg*Math.PI/180)}`,down:i.tilt_down,mechanism:i.tilt_limit.mechanism});let n=(i.pushes??[]).filter(({limit:s})=>s?.mechanism).sort((s,r)=>s.force-r.force);for(let{part:s,direction:r,force:o,limit:a}of n)e.push({label:`push on ${t.shortName(s)}: ${ln(o)}`,part:s,along:r,mechanism:a.mechanism});return e}var ww=i=>(i.limits??[]).filter(({limit:t})=>t?.mechanism).map(({name:t,g:e,direction:n,limit:s})=>({label:`carrier towards ${t}: ${ve(e,3)} g`,along:n,mechanism:s.mechanism}));var og={move:"movements",mass:"masses",size:"sizes",friction:"friction"},Tc=class{constructor(t,e){Object.assign(this,{bench:t,onStage:e,allowed:new Set(["move","mass"]),tilt:""})}controls(t){let{bench:e}=this,n=()=>e.parts.names(),s=Object.entries(og).map(([l,c])=>{let[h,u]=[document.createElement("label"),document.createElement("input")];return Object.assign(u,{type:"checkbox",id:`allow-${l}`,checked:this.allowed.has(l)}),u.addEventListener("change",()=>this.allowed[u.checked?"add":"delete"](l)),h.append(u,` ${c}`),h}),r=document.createElement("input");Object.assign(r,{id:"stand-tilt",placeholder:"2",value:this.tilt}),r.setAttribute("aria-label","tilt up to which it stands [deg]"),r.addEventListener("input",()=>this.tilt=r.value);let o=()=>{let l=cn(Wn(r),1);l?this.allowed.size?t({allow:Object.keys(og).filter(c=>this.allowed.has(c)),tilt:l[0]}):e.complain("Allow a kind of change."):e.complain("Give the tilt in degrees: a number.")},a=document.createElement("span");return a.textContent="deg of tilt, by",[wt("Try changes",()=>t({})),wt("Try to hold selected parts",()=>n().length?t({parts:n()}):e.complain("Select the parts that may be held.")),wt("Make it stand",o,"find the least change after which it stands up to this tilt"),r,a,...s]}tell(t,{changes:e}){let n=[...t.querySelectorAll("[data-change]")],s=()=>n.forEach((r,o)=>r.setAttribute("aria-pressed",String(o===this.onStage.changed)));n.forEach((r,o)=>{r.addEventListener("click",()=>{this.onStage.change(o,e),s(),b("picture").scrollIntoView({block:"nearest"})})}),t.querySelectorAll("[data-make]").forEach((r,o)=>r.addEventListener("click",()=>this.make(e[o],o))),s()}make({action:t},e){let{bench:n}=this;t?n.act(t):n.export(`changed-${e}.kilter.json`,`${n.session.file.replace(/(\.kilter)?\.[^.]*$/,"")}.changed.kilter.json`)}};var Cc=class{constructor(t){Object.assign(this,{bench:t,points:null,tension:""})}controls(){let{bench:t}=this;if(!t.report?.stage)return[];if(!this.points)return[wt("Place a strap",()=>this.begin(),"click its ends and corners in the picture")];let e=document.createElement("input");return e.id="strap-tension",e.placeholder="2000",e.value=this.tension,e.setAttribute("aria-label","tension of the strap [N]"),e.addEventListener("input",()=>this.tension=e.value),[e,wt("Add the strap",()=>this.finish(e)),wt("Cancel",()=>this.end())]}begin(){this.points=[],this.bench.report.tool=this,this.bench.note("Click the first end, the corners and the last end of the strap.",!1),this.bench.tabs.draw()}click(t,e){let{report:n}=this.bench,s=n.stage.hit(t,e);s&&(this.points.push({part:s.part,at:n.stage.parts.rest(s.part,s.local)}),this.draw())}draw(){let{page:t}=this.bench.report;t.straps=[...this.given??=t.straps??[],this.points.map(({at:e})=>e)],this.bench.report.repose()}async finish(t){let{bench:e}=this,{page:n}=e.report,s=cn(Wn(t),1);if(!s||this.points.length<2){e.complain("Click two or more points in the picture, and give the tension in N.");return}let r=({part:l})=>["floor","assumed"].includes(n.parts.held_by[l]),o=this.points.map(l=>[r(l)?"ground":n.parts.full_names[l.part],Xt(l.at,n.center)]);(await e.act({do:"strap",path:o,tension:s[0]})).ok&&this.end()}end(){let{report:t}=this.bench;this.given&&(t.page.straps=this.given),Object.assign(this,{points:null,given:void 0}),t.tool=null,this.bench.note(""),t.repose(),this.bench.tabs.draw()}};var Ew={changes:"Changes",orient:"Which way up",margin:"Margins",helps:"What helps",plan:"Order",hold:"What to hold",transport:"Transport",place:"Place",forces:"Forces",supports:"Supports",contacts:"Contacts",compare:"Compare"},ag=["orient","margin","helps","plan","hold","contacts","forces"],Rc=class{constructor(t){this.bench=t,this.results=new Map,this.asked=new Set,this.now=null,this.moved={},this.places=new sr(t),this.onStage=new Ac(t),this.helps=new Tc(t,this.onStage),this.strap=new Cc(t),this.buttons=Object.entries(Ew).map(([e,n],s)=>{let r=wt(n,()=>this.show(this.now===e?null:e));return r.id=`tab-${e}`,r.setAttribute("role","tab"),r.setAttribute("aria-controls","sheet"),r.tabIndex=s?-1:0,r.dataset.name=e,r}),b("tablist").replaceChildren(...this.buttons),mt("tablist","keydown",e=>zu(this.buttons,e)),mt("copy-tab-command","click",()=>Pi(b("tab-command").textContent,b("copy-tab-command"))),this.mark()}show(t){this.now=t,t&&ag.includes(t)&&!this.results.has(t)&&!this.asked.has(t)&&this.ask({}),this.draw()}mark(){for(let t of this.buttons)t.setAttribute("aria-selected",String(t.dataset.name===this.now));b("sheet").hidden=!this.now,this.now&&b("sheet").setAttribute("aria-labelledby",`tab-${this.now}`)}ask(t,e=this.now){this.asked.add(e),this.results.delete(e),this.bench.act({do:"ask",tab:e,options:t}),this.draw()}moveSupport(t,e){this.moved={...this.moved,[t]:e},e.some(Boolean)||delete this.moved[t],this.now="supports",this.ask({moved:this.moved})}take(t){this.asked.delete(t.name);for(let e of["film","changes","movement"])t[e]&&(t[e]=Xn(t[e]));this.results.set(t.name,t),t.ball&&this.bench.report?.showDirections(Xn(t.ball)),t.name===this.now&&this.draw()}renew(){this.results.clear(),this.asked.clear(),this.bench.report?.page.region&&this.bench.report.showDirections(null),this.draw()}progress(t,e){this.running={what:t,words:e},t&&t===this.now&&this.asked.has(t)&&this.tellProgress()}tellProgress(){let t=this.running?.what===this.now?this.running.words:"";b("sheet-body").textContent=`Being computed${t?`: ${t}`:""} \u2026`}draw(){this.mark();let t=this.now==="place"&&this.results.get("place");this.places.tell(t&&t.place?t:null),this.onStage.tell(this.now,this.results.get(this.now)??null);let{session:e}=this.bench,n=e?.changes.length??0;if(b("tab-changes").textContent=n?`Changes (${n})`:"Changes",!this.now||!e)return;let s=this.results.get(this.now),r=b("sheet-body");if(Hn(b("sheet-controls"),...this.controls(s)),b("sheet-error").hidden=!(s&&s.error),s&&s.error&&(b("sheet-error").textContent=ii(s)),b("sheet-command").hidden=!(s&&s.command),s&&(b("tab-command").textContent=s.command??""),this.now==="changes"){Hn(r,this.changes(e));return}r.replaceChildren(),s?(r.innerHTML=s.html,r.prepend(...this.onStage.content),this.now==="helps"&&this.helps.tell(r,s),this.bench.report&&or(this.bench.report.page,b("sheet"))):this.asked.has(this.now)&&this.tellProgress()}controls(t){let{bench:e}=this,{report:n}=e,s=(c,h)=>wt(c,()=>this.ask(h()));if(this.asked.has(this.now))return[wt("Stop",()=>e.act({do:"stop"}))];if(this.now==="changes")return[];if(this.now==="compare")return this.comparison();let o=this.onStage.controls();if(this.now==="margin")return[s("With the capacity of each part",()=>({loads:!0})),...o];if(this.now==="transport")return[...this.transport(),...o];if(this.now==="helps")return this.helps.controls(c=>this.ask(c));if(this.now==="place")return this.places.controls(c=>this.ask(c));let a=ag.includes(this.now)&&!t?[s("Compute",()=>({}))]:[];this.now==="forces"&&a.push(...this.between()),this.now==="supports"&&a.push(...this.supports()),this.now==="orient"&&t?.data?.found&&a.push(wt("Show this direction",()=>n.turn(t.data.down,{follow:!0})),wt("Use this direction",()=>e.act({do:"gravity",down:t.data.down})));let l=this.now==="hold"?Aw(t):[];return l.length&&a.push(wt(`Hold ${l.map(c=>e.shortName(c)).join(", ")}`,()=>e.act({do:"hold",parts:l,on:!0}))),this.now==="plan"&&t&&t.data&&t.data.found&&a.push(...o,wt("Save the page of the plan",()=>e.export("plan.html"))),a}between(){let{parts:t}=this.bench;return[wt("All pairs",()=>this.ask({})),wt("Between the two selected parts",()=>t.names().length===2?this.ask({between:t.names()}):this.bench.complain("Select two parts that touch."))]}supports(){let t=Object.entries(this.moved).map(([s,r])=>`${this.bench.shortName(s)} by ${r.join(" ")}`),e=document.createElement("span");e.textContent=t.join("; ")||"Select a held part: its card has a field for its movement.";let n=wt("Move all back",()=>{this.moved={},this.results.delete("supports"),this.draw()});return t.length?[e,n]:[e]}transport(){let t=document.createElement("input");t.placeholder="0.5g 0 0",t.setAttribute("aria-label","acceleration of the carrier x y z [m/s\xB2]");let e=document.createElement("select");e.setAttribute("aria-label","rule of load securing");for(let o of["","en12195","en12195:tipping","gdv","vdi2700:3.5t"])e.add(new Option(o||"no rule",o));let n=wt("Limits of all axes",()=>this.ask({})),s=wt("At this acceleration [m/s\xB2]",()=>{let o=cn(Wn(t),3,this.bench.report?.page.gravity);o?this.ask({accelerate:o}):this.bench.complain("Give the acceleration: 3 numbers, separated by spaces, in m/s\xB2 or with g as 0.5g.")}),r=wt("By this rule",()=>e.value?this.ask({code:e.value}):this.bench.complain("Choose a rule."));return[n,t,s,e,r,...this.strap.controls()]}comparison(){let{session:t}=this.bench,e=["as opened",...t.changes.map(({label:o},a)=>`${a+1}: ${o}`)],n=(o,a)=>{let l=document.createElement("select");return l.setAttribute("aria-label",o),e.forEach((c,h)=>l.add(new Option(c,String(h)))),l.value=String(a),l};if(e.length<2){let o=document.createElement("span");return o.textContent="There is no change yet, so there is nothing to compare.",[o]}let[s,r]=[n("first state",0),n("second state",e.length-1)];return[s,r,wt("Compare",()=>{this.asked.add("compare"),this.bench.act({do:"compare",a:Number(s.value),b:Number(r.value)}),this.draw()})]}changes({changes:t,redo:e}){let{bench:n}=this,s=document.createElement("ol");return s.className="entries",s.append(Ie("as opened",...t.length?[wt("Go back to here",()=>n.act({do:"go",index:0}))]:[]),...t.map(({label:r},o)=>{let a=[wt("Revert",()=>n.act({do:"revert",index:o}),"drops this change and keeps the later ones")];return o+1<t.length&&a.push(wt("Go back to here",()=>n.act({do:"go",index:o+1}))),Ie(`${o+1}. ${r}`,...a)}),...e.map(({label:r},o)=>Ie(`undone: ${r}`,...o?[]:[wt("Redo",()=>n.act({do:"redo"}))]))),s}};function Aw(i){return(i?.data?.supports??[]).filter(({kind:e})=>e==="grip").map(({part:e})=>e)}var Tw=60,Cw=80,lg=6e3,Pc=class{constructor({token:t,guides:e}){this.session=null,this.answer=null,document.body.classList.add("bench"),this.layout=new yc,this.layout.opened=n=>n==="gravity"&&this.mapDirections(),this.start=new mc(this),this.forces=new _c(this),this.parts=new Sc(this),this.decide=new gc(this),this.tabs=new Rc(this);for(let n of fc())n.addEventListener("click",()=>this.assume({assume:n.dataset.rung,friction:null}));mt("undo","click",()=>this.act({do:"undo"})),mt("redo","click",()=>this.act({do:"redo"})),mt("save","click",()=>this.save()),mt("show-help","click",()=>this.help.show()),mt("end-trouble","click",()=>b("trouble").hidden=!0),mt("end-message","click",()=>b("message").hidden=!0),mt("stop","click",()=>this.act({do:"stop"})),mt("copy-command","click",()=>Pi(b("command").textContent,b("copy-command"))),mt("export","change",()=>{let n=b("export").value;b("export").value="",n&&this.export(n)}),document.addEventListener("keydown",n=>this.key(n)),this.link=new xc(t,n=>this.hear(n),n=>this.connected(n)),this.help=new vc(e,n=>this.link.address(n))}key(t){if(t.key==="?"&&!t.target.matches?.("input, textarea, select")&&this.help.show(),!(t.ctrlKey||t.metaKey)||t.altKey||!this.session?.file)return;let e=t.target.matches?.("input:not([type=range], [type=checkbox]), textarea"),n=t.key.toLowerCase();if(n==="s")this.save();else if(n==="z"&&!e)this.act({do:t.shiftKey?"redo":"undo"});else if(n==="y"&&!e)this.act({do:"redo"});else return;t.preventDefault()}async act(t){let e=await this.link.send(t);return e.ok?b("trouble").hidden=!0:this.complain(ii(e)),e}assume({assume:t,friction:e}){return this.act({do:"assume",rung:t,...e===null?{}:{mu:e}})}complain(t){b("trouble").hidden=!1,b("trouble-words").textContent=t.charAt(0).toUpperCase()+t.slice(1)}connected(t){b("connection").hidden=t,!t&&(b("connection").textContent=this.link.opened?"The connection to kilter is lost, and the page tries to connect again. Changes until now are kept; if kilter has ended, start it again with kilter view.":`The page has no connection to kilter, and tries again. If a proxy serves this page, it must pass WebSockets on, and kilter view needs the option --host ${location.hostname}.`)}get temporary(){return this.session.temporary}async save(){let t=await this.act({do:"save",file:null});t.ok&&this.temporary&&await this.export("choices.kilter.json",t.saved)}hear(t){let e={session:"tellSession",scene:"showScene",answer:"showAnswer",problem:"tellProblem",progress:"tellProgress",tab:"showTab",probe:"showProbe"}[t.is];e&&this[e](t)}tellSession(t){let e=this.session;this.session=t;let n=!!t.file;for(let s of["save","export","command-line"])b(s).hidden=!n;b("undo").hidden=!n||!t.changes.length,b("redo").hidden=!n||!t.redo.length,b("undo").title=t.changes.length?`undo: ${t.changes.at(-1).label} (Ctrl+Z)`:"",b("title").textContent=t.title,document.title=t.title?`${t.title} \u2013 kilter`:"kilter",b("saved").textContent=n?t.dirty?"not saved":t.saved?`saved: ${t.saved}`:"":"",b("saved").title=n&&this.temporary?"The file was dropped on the page. Saved choices are downloaded: put them beside the file.":"",b("command").textContent=t.command,b("command-note").textContent=t.command_needs_save?"needs the saved choices":"",(!e||t.message!==e.message)&&this.note(t.message,/^saved/.test(t.message)),this.start.tell(t),this.forces.tell(t),(!e||e.state!==t.state)&&this.stale(),t.choices.assume&&dc(t.choices.assume),n?this.report&&e&&e.file===t.file&&(b("show").hidden=!1):b("show").hidden=!0,this.report&&this.parts.tell(),this.bar?.tell(),Rw(),e&&e.file!==t.file&&(b("show").hidden=!0,this.other=!0,this.tabs.moved={})}stale(){if(this.answer=null,this.tabs.renew(),!this.report)return;let t=b("banner");t.dataset.stale="true",t.dataset.phase="",t.setAttribute("aria-busy","true"),b("level").textContent="is being computed anew"}note(t,e=!0){b("message").hidden=!t,b("message-words").textContent=t?t.charAt(0).toUpperCase()+t.slice(1):"",clearTimeout(this.noted),t&&e&&(this.noted=setTimeout(()=>b("message").hidden=!0,lg))}showScene({page:t}){let e=Xn(t);e.shapes??=this.shapes,this.shapes=e.shapes,Km(e.parts);let{down:n}=e;e.given=jm(e.parts.names.length,n,this.other?null:this.report?.page.given),b("show").hidden=!1;let s=b("part").contains(document.activeElement);/^Reading/.test(b("message-words").textContent)&&this.note(""),this.report?this.other?(this.report.restart(e),this.shown=!1):this.report.replace(e):this.begin(e),this.other=!1,this.parts.tellLeftOut(e.left_out??[]),this.forces.tell(this.session),this.parts.tell(),this.bar?.tell(),this.stale(),s&&b("part").hidden&&this.report.tree.focus(this.report.tree.at)}begin(t){if(this.report=new Mc(t),this.report.ladder.choose=n=>this.assume(n),this.report.told=()=>this.tellPhase(),this.report.selected_=()=>{this.parts.tell(),this.bar?.tell()},this.report.key=n=>this.partKey(n),this.report.unknown=n=>this.probe(n),window.kilter=this.report,Ao(this.report,b("printed")),!this.report.stage)return;pc(this.report.stage,b("picture")),new bc(this,b("picture")),this.bar=new Ec(this);let{drawn:e}=this.report.stage;this.report.stage.drawn=()=>{e(),this.bar.place()}}partKey(t){if(t==="Escape"&&this.bar.joining>=0)return this.bar.joining=-1,this.bar.tell(),this.note(""),!0;let e={h:()=>this.parts.hold(),x:()=>this.parts.leaveOut(),Delete:()=>this.parts.leaveOut(),j:()=>this.bar.startJoin()}[t];return!e||!this.report.selection.size?!1:(e(),!0)}showAnswer(t){if(!this.report||t.state!==this.session.state)return;let e=Xn(t.given);if(e.moves.length!==this.report.page.parts.names.length)return;let n=!this.shown;this.shown=t.phase==="complete"||e.moves.some(Boolean),this.answer=t;let s=b("banner");s.scrollTop=0,s.dataset.stale="false",s.dataset.phase=t.phase,s.dataset.state=String(t.state),s.setAttribute("aria-busy",String(t.phase!=="complete")),Pw(this.report.page,t.open),this.tellChange(t,e),this.report.answered(e),n?this.report.reveal():this.report.unveil(),this.layout.now==="gravity"&&this.mapDirections(),this.decide.tell(t),b("answer-html").innerHTML=t.html??"",or(this.report.page,b("answer-section")),b("answer-section").hidden=!t.html}tellChange({phase:t,check:{verdict:e}},{sentence:n}){if(t!=="complete")return;let s=`${this.report.page.words[e]??e}`,r=this.last;if(this.last={now:s,words:n},!r||!/^the file changed/.test(this.session.message))return;let o=r.now===s?`still ${s.toLowerCase()}`:`was: ${r.words} Now: ${n}`;this.note(`${this.session.message}; ${o}`,!1)}tellPhase(){let{phase:t}=this.answer??{};t==="equilibrium"&&this.report.found.from==="given"?b("level").textContent="equilibrium; the complete answer is being computed":!t&&this.report.found.from==="given"&&(b("verdict").textContent="\u2026",b("level").textContent="is being computed",b("moving").textContent="")}tellProblem({state:t,...e}){if(t!==this.session.state)return;let n=b("banner");n.dataset.stale="false",n.dataset.phase="problem",n.dataset.verdict="unknown",n.dataset.state=String(t),n.setAttribute("aria-busy","false"),b("sign").textContent="?",b("verdict").textContent="No answer";for(let s of["level","figure","moving"])b(s).textContent="";b("sentence").textContent=ii(e),this.report?.ladder.tell(null),dc(this.session.choices.assume),(!this.report||b("show").hidden)&&this.complain(ii(e))}tellProgress({what:t,words:e,working:n}){b("progress").hidden=!n,b("progress-words").textContent=e||(t==="answer"?"The answer is being computed.":"Being computed."),this.tabs.progress(t,e),!this.report&&n&&this.note(e&&e!=="reading"?`reading: ${e}`:"reading")}showProbe({state:t,given:e}){t===this.session.state&&this.report?.showProbe(Xn(e))}mapDirections(){let{tabs:t,report:e}=this;if(!e||t.results.has("orient")||t.asked.has("orient"))return;e.page.parts.grounded.filter(s=>!s).length<=Tw&&this.answer?.phase==="complete"&&t.ask({},"orient")}probe(t){this.wanted=t,this.probing??=setTimeout(()=>{this.probing=void 0,this.link.send({do:"probe",down:this.wanted})},Cw)}showTab(t){t.state===this.session.state&&(t.name==="settle"?this.decide.refused(t):this.tabs.take(t))}shortName(t){if(!this.report)return t;let{full_names:e,tails:n}=this.report.page.parts,s=e.indexOf(t);return s<0?t:n[s]}zoomToNames(t){let{full_names:e}=this.report.page.parts,n=t.map(s=>e.indexOf(s)).filter(s=>s>=0);n.length&&this.report.bring(n)}async made(t){if(t==="picture.png")return[await ig(this.report.stage),t];if(t==="film.webm"){let[n,s]=await sg(this);return[n,`film.${s}`]}let e=await fetch(this.link.address(`export/${t}`));if(!e.ok)throw new Error(ii(await e.json()));return[await e.blob(),t]}async export(t,e=""){this.note(`${e||t} is being made`);try{let[n,s]=await this.made(t),r=document.createElement("a");r.href=URL.createObjectURL(n),r.download=e||s,r.click(),setTimeout(()=>URL.revokeObjectURL(r.href),lg),this.note(`${e||s} is downloaded`)}catch(n){this.note(""),this.complain(`${t} was not made: ${n.message}`)}}};function Rw(){let{activeElement:i}=document;if(!i?.closest(".bar")||!i.hidden)return;let t=[...document.querySelectorAll(".bar button")].find(e=>!e.hidden);t&&t.focus()}function Pw({open:i,parts:{full_names:t}},e){let n=(r,o)=>[r,o].sort().join(`
`),s=new Set(e.filter(({decides:r})=>r).map(({parts:[r,o]})=>n(r,o)));i.decides=Array.from({length:i.parts.length/2},(r,o)=>s.has(n(t[i.parts[2*o]],t[i.parts[2*o+1]])))}var Xi=dd(b("data").textContent);Xi&&Xi.workbench?window.bench=new Pc(Xi.workbench):Xi&&(b("show").hidden=!1,window.kilter=Xi.plan?new lc(Xi):new rr(Xi),or(Xi),Ao(window.kilter,b("printed")),window.kilter.stage&&pc(window.kilter.stage,b("picture")));})();
